//! What a critical velocity is read under, beside the settings of the circuit: rate and direction of the command, noise on it, and the
//! threshold above which a swing counts.

use super::recipe::{Problem, Recipe, Record};
use super::table::Table;
use crate::slideway::units::MM_PER_S;
use patchcord_analysis::instruments::{Criterion, CriticalVelocity, NoCriticalVelocity};

/// Conditions, of which every combination is tried.
#[derive(Debug, Clone, Copy)]
pub(super) struct Conditions {
    /// Rates of the command, in m/s2.
    pub rates: &'static [f64],
    /// Noise on the command, rms in m/s.
    pub noises: &'static [f64],
    /// Thresholds, in m/s.
    pub thresholds: &'static [f64],
}

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Under {
    pub rate: f64,
    pub noise: f64,
    pub threshold: f64,
}

/// A number, or none: the table is quiet, or oscillation goes on where the command turns.
pub(super) type Number = Result<f64, Without>;

/// Why there is no number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Without {
    Quiet,
    GoesOn,
}

impl Without {
    fn word(self) -> &'static str {
        match self {
            Without::Quiet => "quiet",
            Without::GoesOn => "goes on",
        }
    }
}

/// What is read under some conditions in one case, while the command rises and while it falls.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reading {
    pub case: String,
    pub under: Under,
    pub rising: Number,
    pub falling: Number,
}

/// What is read while the command goes one way.
pub(super) type Way = (&'static str, fn(&Reading) -> Number);

pub(super) const RISING: Way = ("rising", |reading| reading.rising);
pub(super) const FALLING: Way = ("falling", |reading| reading.falling);

impl Conditions {
    /// The critical velocities of profiles up to a velocity in m/s and back, under all conditions, for each row of values of some
    /// parameters: conditions by conditions, row by row.
    pub fn profiles(
        &self,
        recipe: &Recipe,
        highest: f64,
        vary: &[&str],
        rows: &[Vec<f64>],
    ) -> Result<Vec<(Under, Vec<CriticalVelocity>)>, Problem> {
        let mut found = Vec::new();
        for &rate in self.rates {
            for &noise in self.noises {
                let recipe = recipe.clone().there_and_back(highest, rate).recording(&["v_i", "v_o"]);
                let read = recipe.noisy(noise).each(vary, rows, |run| self.by_threshold(run))?;
                for (index, &threshold) in self.thresholds.iter().enumerate() {
                    let critical = read.iter().map(|critical| critical[index]).collect();
                    found.push((Under { rate, noise, threshold }, critical));
                }
            }
        }
        Ok(found)
    }

    fn by_threshold(&self, run: &Record) -> Result<Vec<CriticalVelocity>, Problem> {
        let criterion = |threshold: &f64| Criterion { threshold: *threshold, ..Criterion::USUAL };
        self.thresholds.iter().map(|threshold| run.critical_by(criterion(threshold))).collect()
    }

    /// The readings as a table: a row for each case, rate and noise, a column for each direction and threshold.
    pub fn table(
        &self,
        reason: &'static str,
        (case, quantity): (&str, &str),
        readings: &[Reading],
        decimals: usize,
    ) -> Table {
        let column = |way: &str| {
            let name = |threshold: &f64| format!("{quantity}, {way}, above {} mm/s", threshold / MM_PER_S);
            self.thresholds.iter().map(name).collect::<Vec<_>>()
        };
        let columns = [column("rising"), column("falling")].concat();
        let first = [case, "rate, mm/s2", "noise, mm/s rms"];
        let mut table = Table::new(reason, first.into_iter().chain(columns.iter().map(String::as_str)));
        let told = |number: Number| {
            number.map_or_else(|none| none.word().to_owned(), |number| format!("{number:.decimals$}"))
        };
        for row in readings.chunks(self.thresholds.len()) {
            let Under { rate, noise, .. } = row[0].under;
            let in_mm = |value: f64| ((value / MM_PER_S * 1e6).round() / 1e6).to_string();
            let cells = [row[0].case.clone(), in_mm(rate), in_mm(noise)].into_iter();
            let rising = row.iter().map(|reading| told(reading.rising));
            let falling = row.iter().map(|reading| told(reading.falling));
            table.rows.push(cells.chain(rising).chain(falling).collect());
        }
        table
    }
}

/// A critical velocity in m/s, or why there is none.
///
/// # Errors
/// Where the run is no profile at all.
pub(super) fn short(velocity: Result<f64, NoCriticalVelocity>) -> Result<Number, Problem> {
    Ok(match velocity {
        Ok(velocity) => Ok(velocity),
        Err(NoCriticalVelocity::NotEnded(_) | NoCriticalVelocity::NotBegun) => Err(Without::GoesOn),
        Err(NoCriticalVelocity::Quiet) => Err(Without::Quiet),
        Err(error) => return Err(error.into()),
    })
}

/// One thing in which readings may differ, the case or a condition.
type Alike = fn(&Reading, &Reading) -> bool;

const IN_CASE: Alike = |one, other| one.under == other.under;

const CONDITIONS: [(&str, Alike); 3] = [
    ("the rate", |one, other| {
        without(one, |under| under.rate = 0.0) == without(other, |under| under.rate = 0.0)
    }),
    ("the threshold", |one, other| {
        without(one, |under| under.threshold = 0.0) == without(other, |under| under.threshold = 0.0)
    }),
    ("noise", |one, other| {
        without(one, |under| under.noise = 0.0) == without(other, |under| under.noise = 0.0)
    }),
];

/// Case and conditions but for one.
fn without(reading: &Reading, forget: fn(&mut Under)) -> (&str, Under) {
    let mut under = reading.under;
    forget(&mut under);
    (&reading.case, under)
}

/// How far apart the numbers of readings lie at most that are alike but for one thing; none where there are no two to compare.
fn moved(readings: &[Reading], number: fn(&Reading) -> Number, alike: Alike) -> Option<f64> {
    let mut most: Option<f64> = None;
    for (index, one) in readings.iter().enumerate() {
        for other in readings[index + 1..].iter().filter(|other| alike(one, other)) {
            if let (Ok(one), Ok(other)) = (number(one), number(other)) {
                most = Some(most.unwrap_or(0.0).max((one - other).abs()));
            }
        }
    }
    most
}

/// "rising, by up to 0.91 with VcL, 0.31 with the rate, 0.05 with the threshold, 0.02 with noise", and the same of falling commands; what
/// cannot be compared is left out. `case` is what cases differ in, if there are several.
pub(super) fn moved_told(readings: &[Reading], decimals: usize, case: Option<&str>) -> String {
    let told = [RISING, FALLING].map(|(way, number)| {
        let cases = case.into_iter().map(|case| (case, IN_CASE));
        let with = cases.chain(CONDITIONS).filter_map(|(name, alike)| {
            Some(format!("{:.decimals$} with {name}", moved(readings, number, alike)?))
        });
        let with = with.collect::<Vec<_>>().join(", ");
        if with.is_empty() { format!("{way}, none to compare") } else { format!("{way}, by up to {with}") }
    });
    told.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Conditions = Conditions { rates: &[1e-3, 2e-3], noises: &[0.0], thresholds: &[1e-4, 2e-4] };

    fn readings() -> Vec<Reading> {
        let mut found = Vec::new();
        for &rate in GRID.rates {
            for &threshold in GRID.thresholds {
                let under = Under { rate, noise: 0.0, threshold };
                let rising = Ok(rate * 1e3 + threshold * 1e3);
                found.push(Reading { case: "one".to_owned(), under, rising, falling: Err(Without::Quiet) });
            }
        }
        found
    }

    #[test]
    fn what_moves_is_told_by_condition() {
        assert_eq!(
            moved_told(&readings(), 2, None),
            "rising, by up to 1.00 with the rate, 0.10 with the threshold; falling, none to compare"
        );
    }

    #[test]
    fn tables_have_a_column_a_direction_and_threshold() {
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
