//! Tests that every claim of the ledger has the verdict that the ledger expects.

use crate::common::files::assert_up_to_date;
use patchcord_thesis::replay::{Claim, ClaimVerdict, ExaminedClaim, claims_page, ledger, run_all};

/// All claims of the ledger.
fn claims() -> Vec<Claim> {
    ledger().unwrap_or_else(|error| panic!("{error}"))
}

/// A message if the verdict of a claim differs from the expected one. `None` if it agrees.
fn unexpected_verdict(row: &ExaminedClaim) -> Option<String> {
    let (claim, outcome) = (&row.claim, &row.outcome);
    (outcome.verdict != claim.verdict).then(|| {
        format!(
            "{}: verdict {}, expected {}: {:?}",
            claim.id, outcome.verdict, claim.verdict, outcome.finding
        )
    })
}

#[test]
#[ignore = "takes two minutes: every row of the ledger"]
fn every_claim_has_its_expected_verdict_and_row_on_the_page() {
    let outcome = run_all(&[], &claims(), 2, |_, _| ());
    let (_, examined) = outcome.unwrap_or_else(|error| panic!("{error}"));
    let unexpected: Vec<_> = examined.iter().filter_map(unexpected_verdict).collect();
    assert!(unexpected.is_empty(), "\n{}", unexpected.join("\n"));
    assert_up_to_date("docs/claims.md", claims_page(&examined).as_bytes(), "patchcord-thesis");
}

#[test]
fn changed_claims_are_detected() {
    let claim = |id: &str| claims().into_iter().find(|claim| claim.id == id).unwrap();
    let mut radius = claim("7-004");
    radius.value.as_mut().unwrap().number *= 1.01;
    assert_eq!(radius.examine().unwrap().verdict, ClaimVerdict::Differs);
    let message = unexpected_verdict(&ExaminedClaim::new(&radius).unwrap()).unwrap();
    assert!(message.starts_with("7-004: verdict differs, expected reproduced"), "{message}");
    radius.value = None;
    assert_eq!(radius.examine().unwrap().verdict, ClaimVerdict::Unknowable);
}
