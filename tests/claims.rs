//! Every claim of the ledger is examined, and comes out as the ledger expects.

use patchcord::replay::{Claim, Verdict, ledger};

fn claims() -> Vec<Claim> {
    let chapters = ledger().unwrap_or_else(|error| panic!("{error}"));
    chapters.into_iter().flat_map(|chapter| chapter.claims).collect()
}

/// What is not as the ledger expects, if anything is.
fn surprise(claim: &Claim) -> Option<String> {
    match claim.examine() {
        Ok(outcome) if outcome.verdict == claim.verdict => None,
        Ok(outcome) => {
            Some(format!("{}: {}, not {}: {:?}", claim.id, outcome.verdict, claim.verdict, outcome.finding))
        }
        Err(error) => Some(format!("{}: {error}", claim.id)),
    }
}

#[test]
fn every_claim_comes_out_as_expected() {
    let surprises: Vec<_> = claims().iter().filter_map(surprise).collect();
    assert!(surprises.is_empty(), "\n{}", surprises.join("\n"));
}

#[test]
fn a_claim_that_says_something_else_is_noticed() {
    let of = |id: &str| claims().into_iter().find(|claim| claim.id == id).unwrap();
    let mut radius = of("7-004");
    radius.value.as_mut().unwrap().number *= 1.01;
    assert_eq!(radius.examine().unwrap().verdict, Verdict::Differs);
    assert!(surprise(&radius).unwrap().starts_with("7-004: differs, not reproduced"));
    radius.value = None;
    assert_eq!(radius.examine().unwrap().verdict, Verdict::Unknowable);
}
