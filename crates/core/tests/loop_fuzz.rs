//! Random patches without integrators against an enumeration of all linear cases. The bench `loops` compares more.

use crate::common::curved_patches;
use crate::common::static_patches::{Tally, compare_random, random_count, random_patch, random_summers};

/// Checks that nothing differs and that at least this many patches had one solution.
fn check(tally: &Tally, least: usize) {
    let shown = &tally.different[..tally.different.len().min(3)];
    assert!(shown.is_empty(), "{} differ, among them:\n{}", tally.different.len(), shown.join("\n\n"));
    assert!(tally.equal >= least, "only {} of the patches had one solution", tally.equal);
}

#[test]
fn random_static_patches_have_the_voltages_of_an_enumeration() {
    let tally = compare_random(1, 500, |random| {
        let count = random_count(random, 2, 6);
        random_patch(random, count)
    });
    check(&tally, 200);
}

#[test]
fn random_systems_of_summers_have_the_voltages_of_an_enumeration() {
    let tally = compare_random(2, 150, |random| {
        let count = random_count(random, 2, 7);
        random_summers(random, count)
    });
    check(&tally, 50);
}

#[test]
fn random_patches_with_products_have_one_solution_that_satisfies_all_laws() {
    let tally = curved_patches::check_random(3, 300);
    assert!(tally.wrong.is_empty(), "{} are wrong, among them:\n{}", tally.wrong.len(), tally.wrong[0]);
    assert!(tally.solved > 60, "only {} of the patches were solved", tally.solved);
}
