//! The conditions under which a critical velocity is read, and how strongly it depends on each of them.
//!
//! The conditions are the rate of the command, the noise on it, and the threshold above which a swing counts as
//! oscillation. Every combination is run. The results are formatted as a table, and as one line that states the
//! largest change with each condition alone.
//!
//! A case is one setting of the circuit. Its readings are compared in pairs that differ in one condition only, so a
//! change belongs to that condition alone.

use super::number_table::NumberTable;
use super::recipe::{BoxError, Recipe};
use super::run_record::RunRecord;
use crate::slideway::units::MM_PER_S;
use patchcord_analysis::instruments::{Criterion, CriticalVelocity, CriticalVelocityError};
use patchcord_expr::format_decimals;

/// Lists of conditions. Every combination is run.
#[derive(Debug, Clone, Copy)]
pub(super) struct ReadingConditions {
    /// Rates of the velocity command, in m/s2.
    pub rates: &'static [f64],
    /// Noise on the velocity command, rms in m/s; 0 for none.
    pub noises: &'static [f64],
    /// Thresholds of the peak-to-peak swing, in m/s.
    pub thresholds: &'static [f64],
}

/// One combination of conditions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Condition {
    /// Rate of the velocity command, in m/s2.
    pub rate: f64,
    /// Noise on the velocity command, rms in m/s.
    pub noise: f64,
    /// Threshold of the peak-to-peak swing, in m/s.
    pub threshold: f64,
}

/// A number that was read, or the reason why there is none.
pub(super) type ReadNumber = Result<f64, NoNumber>;

/// The reason why no critical velocity was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoNumber {
    /// No swing exceeds the threshold.
    Quiet,
    /// Oscillation has not ended where the command turns.
    Continues,
}

impl NoNumber {
    /// The entry in tables.
    fn text(self) -> &'static str {
        match self {
            NoNumber::Quiet => "quiet",
            NoNumber::Continues => "continues",
        }
    }
}

/// The numbers read in one case under one combination of conditions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ConditionReading {
    /// The settings of the circuit, as the first column of the table prints them.
    pub case: String,
    /// The conditions.
    pub condition: Condition,
    /// The number read while the command rises.
    pub rising: ReadNumber,
    /// The number read while the command falls.
    pub falling: ReadNumber,
}

/// A direction of the command: its name, and the function that selects its number.
pub(super) type ReadDirection = (&'static str, fn(&ConditionReading) -> ReadNumber);

/// Selects the number read while the command rises.
pub(super) const RISING: ReadDirection = ("rising", |reading| reading.rising);
/// Selects the number read while the command falls.
pub(super) const FALLING: ReadDirection = ("falling", |reading| reading.falling);

impl ReadingConditions {
    /// Reads the critical velocities of profiles under all conditions. The command rises to `highest` (in m/s) and
    /// falls back to 0. Each row of `rows` holds values of the parameters `vary`.
    ///
    /// Returns one entry per combination of conditions, with one result per row. The threshold changes fastest, then
    /// the noise, then the rate.
    ///
    /// # Errors
    /// If a run fails, or if an amplifier is overloaded. The error states the values of that run.
    pub(super) fn profiles(
        &self,
        recipe: &Recipe,
        highest: f64,
        vary: &[&str],
        rows: &[Vec<f64>],
    ) -> Result<Vec<(Condition, Vec<CriticalVelocity>)>, BoxError> {
        let mut found = Vec::new();
        for &rate in self.rates {
            for &noise in self.noises {
                let recipe = recipe.clone().triangle_command(highest, rate).record(&["v_i", "v_o"]);
                let read = recipe.command_noise(noise).run_rows(vary, rows, |run| self.by_threshold(run))?;
                for (index, &threshold) in self.thresholds.iter().enumerate() {
                    let critical = read.iter().map(|critical| critical[index]).collect();
                    found.push((Condition { rate, noise, threshold }, critical));
                }
            }
        }
        Ok(found)
    }

    /// Reads the critical velocities of one run with each threshold.
    fn by_threshold(&self, run: &RunRecord) -> Result<Vec<CriticalVelocity>, BoxError> {
        let criterion = |threshold: &f64| Criterion { threshold: *threshold, ..Criterion::USUAL };
        self.thresholds.iter().map(|threshold| run.critical_velocity_by(criterion(threshold))).collect()
    }

    /// Formats the readings as a table. A row is a case with a rate and a noise. A column is a direction with a
    /// threshold.
    ///
    /// `case` and `quantity` are column headings. `readings` has the order of [`ReadingConditions::profiles`], case
    /// by case.
    pub(super) fn table(
        &self,
        reason: &'static str,
        (case, quantity): (&str, &str),
        readings: &[ConditionReading],
        decimals: usize,
    ) -> NumberTable {
        let column = |direction: &str| {
            let name =
                |threshold: &f64| format!("{quantity}, {direction}, above {} mm/s", threshold / MM_PER_S);
            self.thresholds.iter().map(name).collect::<Vec<_>>()
        };
        let columns = [column("rising"), column("falling")].concat();
        let first = [case, "rate, mm/s2", "noise, mm/s rms"];
        let mut table = NumberTable::new(reason, first.into_iter().chain(columns.iter().map(String::as_str)));
        let text = |number: ReadNumber| {
            number.map_or_else(|none| none.text().to_owned(), |number| format!("{number:.decimals$}"))
        };
        for row in readings.chunks(self.thresholds.len()) {
            let Condition { rate, noise, .. } = row[0].condition;
            let in_mm = |value: f64| format_decimals(value / MM_PER_S, 6);
            let cells = [row[0].case.clone(), in_mm(rate), in_mm(noise)].into_iter();
            let rising = row.iter().map(|reading| text(reading.rising));
            let falling = row.iter().map(|reading| text(reading.falling));
            table.rows.push(cells.chain(rising).chain(falling).collect());
        }
        table
    }
}

/// Separates runs without a critical velocity from errors.
///
/// # Errors
/// If the run is not a velocity profile.
pub(super) fn read_number(velocity: Result<f64, CriticalVelocityError>) -> Result<ReadNumber, BoxError> {
    Ok(match velocity {
        Ok(velocity) => Ok(velocity),
        Err(CriticalVelocityError::NotEnded(_) | CriticalVelocityError::NotBegun) => Err(NoNumber::Continues),
        Err(CriticalVelocityError::NoOscillation) => Err(NoNumber::Quiet),
        Err(error) => return Err(error.into()),
    })
}

/// Returns whether two readings agree in everything except one condition, or except the case.
type Agreement = fn(&ConditionReading, &ConditionReading) -> bool;

/// The readings differ at most in the case.
const EXCEPT_CASE: Agreement = |one, other| one.condition == other.condition;

/// Names of the conditions, each with a comparison that ignores that condition.
const EXCEPT_CONDITION: [(&str, Agreement); 3] = [
    ("the rate", |one, other| {
        ignoring(one, |condition| condition.rate = 0.0) == ignoring(other, |condition| condition.rate = 0.0)
    }),
    ("the threshold", |one, other| {
        ignoring(one, |condition| condition.threshold = 0.0)
            == ignoring(other, |condition| condition.threshold = 0.0)
    }),
    ("noise", |one, other| {
        ignoring(one, |condition| condition.noise = 0.0) == ignoring(other, |condition| condition.noise = 0.0)
    }),
];

/// Returns case and conditions, with one condition reset so that comparisons ignore it.
fn ignoring(reading: &ConditionReading, reset: fn(&mut Condition)) -> (&str, Condition) {
    let mut condition = reading.condition;
    reset(&mut condition);
    (&reading.case, condition)
}

/// Returns the largest difference between the numbers of two readings that agree in everything except one thing.
/// `None` if there are no two numbers to compare.
fn largest_change(
    readings: &[ConditionReading],
    number: fn(&ConditionReading) -> ReadNumber,
    agrees: Agreement,
) -> Option<f64> {
    let mut largest: Option<f64> = None;
    for (index, one) in readings.iter().enumerate() {
        for other in readings[index + 1..].iter().filter(|other| agrees(one, other)) {
            if let (Ok(one), Ok(other)) = (number(one), number(other)) {
                largest = Some(largest.unwrap_or(0.0).max((one - other).abs()));
            }
        }
    }
    largest
}

/// Formats how strongly a number depends on each condition: "rising, by up to 0.91 with VcL, 0.31 with the rate, 0.05
/// with the threshold, 0.02 with noise", and the same for falling commands. A condition without two numbers to
/// compare is omitted. `case` names the difference between cases, if there are several.
pub(super) fn format_changes(readings: &[ConditionReading], decimals: usize, case: Option<&str>) -> String {
    let texts = [RISING, FALLING].map(|(direction, number)| {
        let cases = case.into_iter().map(|case| (case, EXCEPT_CASE));
        let with = cases.chain(EXCEPT_CONDITION).filter_map(|(name, agrees)| {
            Some(format!("{:.decimals$} with {name}", largest_change(readings, number, agrees)?))
        });
        let with = with.collect::<Vec<_>>().join(", ");
        if with.is_empty() {
            format!("{direction}, none to compare")
        } else {
            format!("{direction}, by up to {with}")
        }
    });
    texts.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: ReadingConditions =
        ReadingConditions { rates: &[1e-3, 2e-3], noises: &[0.0], thresholds: &[1e-4, 2e-4] };

    fn readings() -> Vec<ConditionReading> {
        let mut found = Vec::new();
        for &rate in GRID.rates {
            for &threshold in GRID.thresholds {
                let condition = Condition { rate, noise: 0.0, threshold };
                let rising = Ok(rate * 1e3 + threshold * 1e3);
                found.push(ConditionReading {
                    case: "one".to_owned(),
                    condition,
                    rising,
                    falling: Err(NoNumber::Quiet),
                });
            }
        }
        found
    }

    #[test]
    fn changes_are_listed_by_condition() {
        assert_eq!(
            format_changes(&readings(), 2, None),
            "rising, by up to 1.00 with the rate, 0.10 with the threshold; falling, none to compare"
        );
    }

    #[test]
    fn tables_have_one_column_per_direction_and_threshold() {
        let table = GRID.table("", ("case", "Vc"), &readings(), 1);
        assert_eq!(
            table.head[3..],
            [
                "Vc, rising, above 0.1 mm/s",
                "Vc, rising, above 0.2 mm/s",
                "Vc, falling, above 0.1 mm/s",
                "Vc, falling, above 0.2 mm/s"
            ]
        );
        assert_eq!(table.rows[1], ["one", "2", "0", "2.1", "2.2", "quiet", "quiet"]);
    }
}
