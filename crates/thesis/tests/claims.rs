//! Every claim of the ledger is examined, and comes out as the ledger expects.

use crate::common::files::check_fresh;
use patchcord_thesis::replay::{Claim, Examined, Verdict, ledger, page, perform};

fn claims() -> Vec<Claim> {
    ledger().unwrap_or_else(|error| panic!("{error}"))
}

/// What is not as the ledger expects, if anything is.
fn surprise(row: &Examined) -> Option<String> {
    let (claim, found) = (&row.claim, &row.outcome);
    (found.verdict != claim.verdict)
        .then(|| format!("{}: {}, not {}: {:?}", claim.id, found.verdict, claim.verdict, found.finding))
}

#[test]
#[ignore = "takes two minutes: every row of the ledger"]
fn every_claim_comes_out_as_expected_and_stands_on_the_page() {
    let performed = perform(&[], &claims(), 2, |_, _| ());
    let (_, examined) = performed.unwrap_or_else(|error| panic!("{error}"));
    let surprises: Vec<_> = examined.iter().filter_map(surprise).collect();
    assert!(surprises.is_empty(), "\n{}", surprises.join("\n"));
    check_fresh("docs/claims.md", page(&examined).as_bytes(), "patchcord-thesis");
}

#[test]
fn a_claim_that_says_something_else_is_noticed() {
    let of = |id: &str| claims().into_iter().find(|claim| claim.id == id).unwrap();
    let mut radius = of("7-004");
    radius.value.as_mut().unwrap().number *= 1.01;
    assert_eq!(radius.examine().unwrap().verdict, Verdict::Differs);
    assert!(surprise(&Examined::of(&radius).unwrap()).unwrap().starts_with("7-004: differs, not reproduced"));
    radius.value = None;
    assert_eq!(radius.examine().unwrap().verdict, Verdict::Unknowable);
}
