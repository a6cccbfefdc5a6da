//! The result of the search in one case, and its judgement by the truth.

use std::fmt::Write as _;
use std::time::Instant;

use serde_json::Value;

use crate::Outcome;
use crate::hidden_cases::{HiddenCases, HiddenEffect, Truth, in_si};
use patchcord::expr::Unit;
use patchcord::ident::{Report, Verdict};
use patchcord::{Experiment, Library, Outcome as SearchOutcome, Problem, SearchSettings};

/// The judgement of a verdict by the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Judgement {
    /// All hidden effects are named and no other; or nothing is hidden, and the verdict says so.
    Right,
    /// One of two hidden effects is named, and no other.
    Half,
    /// The verdict is ambiguous, and at every step a hidden effect is among the named ones.
    Among,
    /// Nothing is named although an effect is hidden, or the verdict is inconclusive.
    Refused,
    /// A named effect is not hidden, but it is an alias of a hidden one: some data cannot distinguish the two.
    Alias,
    /// A named effect is neither hidden nor an alias of a hidden one.
    Wrong,
    /// Nothing is hidden, but the verdict is that something is missing.
    FalseAlarm,
}

impl Judgement {
    /// All judgements, in the order of the page's columns.
    pub(crate) const ALL: [Judgement; 7] = [
        Judgement::Right,
        Judgement::Half,
        Judgement::Among,
        Judgement::Refused,
        Judgement::Alias,
        Judgement::Wrong,
        Judgement::FalseAlarm,
    ];

    /// The heading of its column. The journal contains the same text.
    pub(crate) fn as_str(self) -> &'static str {
        match self {
            Judgement::Right => "right",
            Judgement::Half => "one of two",
            Judgement::Among => "among two",
            Judgement::Refused => "refused",
            Judgement::Alias => "an alias",
            Judgement::Wrong => "wrong name",
            Judgement::FalseAlarm => "false alarm",
        }
    }
}

/// The result of the search in a case.
pub(crate) struct CaseResult {
    /// Number of the case, from 1.
    pub number: usize,
    pub truth: Truth,
    /// The verdict as a word, such as "named".
    pub verdict: String,
    /// Name and site of every named effect.
    pub named: Vec<(String, String)>,
    pub judgement: Judgement,
    /// Parameters of rightly named effects whose true values are known.
    pub parameters: Vec<ParameterEstimate>,
    /// The rms residual of the reported model in the validation data, over the noise.
    pub validation_residual: f64,
    /// Duration of the search in s.
    pub seconds: f64,
    /// The trials of the search as text for `-v`. Empty if the result is from a journal.
    pub search_log: String,
}

/// A fitted parameter and its true value, in SI units.
pub(crate) struct ParameterEstimate {
    /// Name of the effect.
    pub effect: String,
    /// Name of the parameter.
    pub name: String,
    pub truth: f64,
    pub fitted: f64,
    /// The 95 % interval that the search reports. Infinite ends if it reports none.
    pub interval: [f64; 2],
}

impl CaseResult {
    /// Searches a case with seed 1 and judges the outcome.
    ///
    /// # Errors
    ///
    /// If the experiment cannot be read or its patch cannot be run.
    pub(crate) fn search(
        number: usize,
        cases: &HiddenCases,
        library: &Library,
        threads: usize,
    ) -> Outcome<CaseResult> {
        let truth = cases.truth(number)?;
        let began = Instant::now();
        let experiment = Experiment::read(cases.experiment(number)).map_err(|error| error.to_string())?;
        let problem = Problem::of(&experiment)?;
        let settings = SearchSettings::new(library).with_threads(threads);
        let outcome = patchcord::search(&experiment, &problem, &settings, |_| ())?;
        let seconds = began.elapsed().as_secs_f64();
        let Some(outcome) = outcome else { return Err(format!("case {number} cannot be run").into()) };
        let report = Report::new(&experiment, &problem, &outcome);
        let effects = report.json()["effects"].as_array().cloned().unwrap_or_default();
        let string = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let named: Vec<_> =
            effects.iter().map(|effect| (string(&effect["name"]), string(&effect["junction"]))).collect();
        let steps = effects.chunk_by(|effect, next| effect["step"] == next["step"]);
        let steps: Vec<Vec<String>> =
            steps.map(|step| step.iter().map(|effect| string(&effect["name"])).collect()).collect();
        let judgement = judge(&truth, outcome.verdict, &steps, library);
        Ok(CaseResult {
            verdict: outcome.verdict.as_str().to_owned(),
            judgement,
            parameters: parameter_estimates(&truth, &effects),
            validation_residual: outcome.reported_model().validation.normalised_rms(),
            search_log: search_log(&problem, &outcome),
            number,
            truth,
            named,
            seconds,
        })
    }

    /// Whether all rightly named effects are named at their true places. `None` if no effect is rightly named.
    pub(crate) fn is_in_place(&self) -> Option<bool> {
        let in_place = self.named.iter().filter_map(|(name, site)| {
            let hidden = self.truth.effects.iter().find(|hidden| hidden.name == *name)?;
            Some(hidden.site == *site)
        });
        in_place.reduce(|all, next| all && next)
    }

    /// The result in one line of text.
    pub(crate) fn line(&self) -> String {
        let named: Vec<_> = self.named.iter().map(|(name, site)| format!("{name}@{site}")).collect();
        let max_error = self.parameters.iter().map(ParameterEstimate::relative_error).fold(0.0, f64::max);
        format!(
            "{:04} {:<44} {:7.2}  {:<15} {:<44} {:?} validation {:.3} error {:.3} {:.1} s",
            self.number,
            self.truth.what,
            self.truth.egnr,
            self.verdict,
            named.join("+"),
            self.judgement,
            self.validation_residual,
            max_error,
            self.seconds
        )
    }
}

/// The fitted parameters of all named effects that are hidden, if their true values are known and not 0.
fn parameter_estimates(truth: &Truth, effects: &[Value]) -> Vec<ParameterEstimate> {
    let estimates = truth.effects.iter().flat_map(|hidden| {
        let named = effects.iter().find(|effect| effect["name"] == hidden.name.as_str());
        let true_values = hidden.parameters.iter().filter(|(_, value)| **value != 0.0);
        true_values.filter_map(move |(name, value)| {
            ParameterEstimate::of(&hidden.name, name, *value, &named?["parameters"][name])
        })
    });
    estimates.collect()
}

impl ParameterEstimate {
    /// The estimate from a parameter of the report. The true value is in SI units. `None` if the report lacks the
    /// value.
    fn of(effect: &str, name: &str, truth: f64, fitted: &Value) -> Option<ParameterEstimate> {
        let unit = Unit::parse(fitted["unit"].as_str()?).ok()?;
        let end = |index: usize| fitted["interval"][index].as_f64().map(|end| unit.to_si(end));
        Some(ParameterEstimate {
            effect: effect.to_owned(),
            name: name.to_owned(),
            truth,
            fitted: in_si(fitted)?,
            interval: [end(0).unwrap_or(f64::NEG_INFINITY), end(1).unwrap_or(f64::INFINITY)],
        })
    }

    /// The error of the fitted value as a share of the true value.
    pub(crate) fn relative_error(&self) -> f64 {
        (self.fitted - self.truth).abs() / self.truth.abs()
    }

    /// Whether the interval contains the true value.
    pub(crate) fn is_covered(&self) -> bool {
        (self.interval[0]..=self.interval[1]).contains(&self.truth)
    }
}

/// Whether one effect is an alias of the other in the library, so that some data cannot distinguish them.
fn are_aliases(library: &Library, one: &str, other: &str) -> bool {
    let has = |name: &str, alias: &str| {
        library.iter().any(|effect| effect.name == name && effect.aliases.contains_key(alias))
    };
    has(one, other) || has(other, one)
}

/// Judges a verdict. `steps` has the names of every step: one if it is decided, several if it is ambiguous.
fn judge(truth: &Truth, verdict: Verdict, steps: &[Vec<String>], library: &Library) -> Judgement {
    let is_hidden = |name: &String| truth.effects.iter().any(|hidden| hidden.name == *name);
    let is_hidden_or_alias = |name: &String| {
        is_hidden(name) || truth.effects.iter().any(|hidden| are_aliases(library, name, &hidden.name))
    };
    let named = || steps.iter().flatten();
    let is_named = |hidden: &HiddenEffect| named().filter(|name| hidden.name == **name).count() == 1;
    let all_steps_hidden = steps.iter().all(|names| names.iter().any(is_hidden));
    match verdict {
        Verdict::NothingMissing if truth.effects.is_empty() => Judgement::Right,
        Verdict::UnknownEffect | Verdict::Named | Verdict::Ambiguous if truth.effects.is_empty() => {
            Judgement::FalseAlarm
        }
        Verdict::UnknownEffect if truth.what.starts_with("unknown") => Judgement::Right,
        Verdict::NothingMissing | Verdict::UnknownEffect | Verdict::CannotJudge => Judgement::Refused,
        Verdict::Ambiguous if all_steps_hidden => Judgement::Among,
        Verdict::Named if all_steps_hidden && truth.effects.iter().all(is_named) => Judgement::Right,
        Verdict::Named if all_steps_hidden && steps.len() < truth.effects.len() => Judgement::Half,
        _ if !all_steps_hidden && named().all(is_hidden_or_alias) => Judgement::Alias,
        _ => Judgement::Wrong,
    }
}

/// Trials of a round that the log lists, the best ones.
const LISTED_TRIALS: usize = 60;

/// The log of a search: the base, the best trials of every round, and the localisation.
fn search_log(problem: &Problem, outcome: &SearchOutcome) -> String {
    let mut text = base_line(problem, outcome);
    for round in &outcome.rounds {
        let _ = writeln!(
            text,
            "     required {:.1}, advantage in validation {:.1} +- {:.1}, tied {}, taken {}",
            round.required_delta_bic,
            round.validation_advantage.sum,
            round.validation_advantage.standard_error,
            round.tied,
            round.taken
        );
        let base_count = round.before.train.estimate.parameters.len();
        for trial in round.trials.iter().take(LISTED_TRIALS) {
            let (train, validation) = (&trial.model.train, &trial.model.validation);
            let _ = writeln!(
                text,
                "       {:<26} {:<5} delta BIC {:>9.1} train {:.3} validation {:.3} Ljung-Box z {:.1} \
                 autocorrelation time {:.1} advantage of best {:.1} +- {:.1} {:?}",
                trial.candidate.effect,
                trial.candidate.site,
                trial.delta_bic,
                train.reduced_chi2(),
                validation.reduced_chi2(),
                trial.model.ljung_box_z,
                trial.model.autocorrelation_time,
                trial.best_advantage.sum,
                trial.best_advantage.standard_error,
                &train.estimate.parameters[base_count..]
            );
        }
    }
    for localisation in &outcome.localisations {
        let curves = localisation.curves.iter().map(|curve| {
            format!(
                "{} {:.3} validation {:.3?}",
                curve.regressor, curve.explained_fraction, curve.validation_fraction
            )
        });
        let _ = writeln!(
            text,
            "     at {} explained {:.3} evidence {:.1} best {} ({})",
            localisation.junction,
            localisation.explained_fraction,
            localisation.evidence,
            localisation.best_regressor(),
            curves.collect::<Vec<_>>().join(", ")
        );
    }
    let _ = write!(text, "     remaining {:.3}", outcome.remaining_fraction);
    text
}

/// The line of the search log on the base.
fn base_line(problem: &Problem, outcome: &SearchOutcome) -> String {
    let base = &outcome.base;
    format!(
        "     base {:.3} Ljung-Box z {:.1} autocorrelation time {:.1} parameters {:?} sigma {:?} steps {}\n",
        base.train.reduced_chi2(),
        base.ljung_box_z,
        base.autocorrelation_time,
        base.train.estimate.parameters,
        problem.sigma,
        problem.steps
    )
}
