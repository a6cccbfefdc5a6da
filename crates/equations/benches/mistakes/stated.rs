//! Mistakes in patches that state their equations.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use patchcord_core::patch::Edit;
use patchcord_equations::{
    Agreement, ComparedEquation, Fix, compare_equations, equation_findings, find_fixes,
};

use crate::Options;
use crate::document::meaning;
use crate::mistake::{Class, Mistake};
use crate::patches::{Collection, CorrectPatch, compiled, correct_patches};
use crate::random::SplitMix64;

/// Places in the list of changes that count.
const PLACES: usize = 3;
/// Required shares of the mistakes: those that are detected, those whose cause is the first change, and those whose
/// cause is among the first three.
const TARGETS: [f64; 3] = [1.0, 0.9, 0.98];

/// The result of one case.
struct CaseResult {
    /// The kind of mistake.
    class: Class,
    /// Whether there is a finding.
    is_detected: bool,
    /// The index of the first change that names the cause. `None` if there is none.
    place: Option<usize>,
    /// The time of the comparison and of the search for changes.
    seconds: f64,
    /// The mistake, the findings and the changes.
    text: String,
}

/// Makes one mistake in each correct patch. Prints the cases whose first change does not name the cause, and a table.
/// Returns whether the shares reach their targets and the correct patches have no findings.
pub(crate) fn report(options: &Options) -> bool {
    let start = Instant::now();
    let Collection { patches, unsolved_variants } = correct_patches(options.patches);
    let findings: usize = patches.iter().map(finding_count).sum();
    println!("{} correct patches in {:.1} s", patches.len(), start.elapsed().as_secs_f64());
    println!("variants left out because their wiring does not solve the equations: {unsolved_variants}\n");
    let (mut results, mut panics) = (Vec::new(), 0);
    for (number, correct) in patches.iter().enumerate() {
        if options.case.is_some_and(|case| case != number) {
            continue;
        }
        match catch_unwind(AssertUnwindSafe(|| case_result(correct, options.seed, number))) {
            Ok(Some(result)) => {
                if result.place != Some(0) || options.case.is_some() {
                    println!("case {number}, {}: {}", correct.name, result.text);
                }
                results.push(result);
            }
            Ok(None) => println!("case {number}, {}: no mistake applies", correct.name),
            Err(_) => {
                println!("case {number}, {}: panic", correct.name);
                panics += 1;
            }
        }
    }
    println!("\nfindings on the correct patches: {findings}");
    if panics > 0 {
        println!("cases with a panic: {panics}");
    }
    print_table(&results) && findings == 0 && panics == 0
}

/// The number of warnings of a correct patch, and of its equations that the wiring does not solve.
fn finding_count(correct: &CorrectPatch) -> usize {
    compiled(&correct.patch).map_or(1, |(circuit, program)| {
        let compared = compare_equations(&circuit, &program);
        circuit.warnings().findings.len() + equation_findings(&circuit, &program, &compared).len()
    })
}

/// Makes a mistake in a correct patch, compares its equations, and searches for changes. `None` if no mistake applies.
///
/// These are the steps of [`equation_findings`], which returns the changes only as text.
fn case_result(correct: &CorrectPatch, seed: u64, number: usize) -> Option<CaseResult> {
    let mut random = SplitMix64(seed.wrapping_mul(1_000_003).wrapping_add(number as u64));
    let mistake = Mistake::random(&correct.patch, &mut random)?;
    let start = Instant::now();
    let compared = compare_equations(&mistake.circuit, &mistake.program);
    let fixes = find_fixes(&mistake.circuit, &mistake.program, &compared);
    let seconds = start.elapsed().as_secs_f64();
    let findings: Vec<String> = compared.iter().filter_map(finding).collect();
    let changes: Vec<String> = fixes.iter().map(|fix| fix.description.clone()).collect();
    let Mistake { class, description, .. } = &mistake;
    let text = format!(
        "{}: {description} | findings: {} | changes: {}",
        class.name(),
        list(&findings),
        list(&changes)
    );
    Some(CaseResult {
        class: *class,
        is_detected: !findings.is_empty(),
        place: fixes.iter().position(|fix| names_cause(fix, correct, &mistake)),
        seconds,
        text,
    })
}

/// The finding about an equation. `None` if the wiring solves it.
fn finding(compared: &ComparedEquation) -> Option<String> {
    match &compared.agreement {
        Agreement::Different { differences, .. } => Some(differences.join(", ")),
        Agreement::SolvedAt(names) => {
            Some(format!("it holds for the present values of {} only", names.join(", ")))
        }
        Agreement::Undecided(reason) => Some(reason.clone()),
        _ => None,
    }
}

/// Texts in one line; "none" if there are none.
fn list(texts: &[String]) -> String {
    if texts.is_empty() { "none".to_owned() } else { texts.join("; ") }
}

/// Whether a change names the cause of the findings: it restores the correct patch, or it changes the element or scale
/// with the mistake.
fn names_cause(fix: &Fix, correct: &CorrectPatch, mistake: &Mistake) -> bool {
    let corrected = mistake.patch.with_edits(mistake.patch.file(), &fix.edits);
    let is_restored =
        corrected.is_ok_and(|corrected| meaning(corrected.value()) == meaning(correct.patch.value()));
    let entry = |path: &[String]| path.iter().take(2).cloned().collect::<Vec<_>>();
    let is_wrong = |edit: &Edit| mistake.edits.iter().any(|wrong| entry(edit.path()) == entry(wrong.path()));
    is_restored || fix.edits.iter().any(is_wrong)
}

/// Prints a row for each kind of mistake, the shares of all mistakes, and the times. Returns whether the shares reach
/// their targets.
fn print_table(results: &[CaseResult]) -> bool {
    println!("\nclass            mistakes  detected  cause first  among the first {PLACES}");
    for class in Class::ALL {
        let own: Vec<&CaseResult> = results.iter().filter(|result| result.class == class).collect();
        print_row(class.name(), own.len(), counts(&own));
    }
    let all: Vec<&CaseResult> = results.iter().collect();
    let counts = counts(&all);
    print_row("all", all.len(), counts);
    let shares = counts.map(|count| count as f64 / all.len().max(1) as f64);
    let [detected, first, among] = shares.map(|share| format!("{:.1} %", 100.0 * share));
    println!("share{detected:>30}  {first:>11}  {among:>17}");
    let mut seconds: Vec<f64> = results.iter().map(|result| result.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    if let Some(longest) = seconds.last() {
        println!("\ntime per patch: median {:.2} s, maximum {longest:.2} s", seconds[seconds.len() / 2]);
    }
    shares.iter().zip(TARGETS).all(|(share, target)| *share >= target)
}

/// The numbers of mistakes that are detected, whose cause is the first change, and whose cause is among the first
/// three.
fn counts(results: &[&CaseResult]) -> [usize; 3] {
    let count =
        |is_counted: fn(&CaseResult) -> bool| results.iter().filter(|result| is_counted(result)).count();
    [
        count(|result| result.is_detected),
        count(|result| result.place == Some(0)),
        count(|result| result.place.is_some_and(|place| place < PLACES)),
    ]
}

/// Prints a row of the table.
fn print_row(name: &str, mistakes: usize, [detected, first, among]: [usize; 3]) {
    println!("{name:15}  {mistakes:8}  {detected:8}  {first:11}  {among:17}");
}
