//! Runs many cases and keeps those that break a rule.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;
use std::{fs, io, thread};

use tempfile::TempDir;

use super::case::Case;
use super::command_lines::SWEEP;
use super::judgement::{answer_violations, violations};
use super::runner::{Answer, run};
use super::streams::quoted;
use super::sweep_damage::DamagedTable;

/// The number of commands that run at the same time.
const THREADS: usize = 2;

/// The file that describes how to repeat a case.
const DESCRIPTION: &str = "command.txt";

/// The results of many cases.
#[derive(Debug, Default)]
pub(crate) struct Summary {
    /// The number of cases.
    pub cases: usize,
    /// The number of accepted cases, with exit code 0, and of all cases of each command.
    pub commands: BTreeMap<String, [usize; 2]>,
    /// The number of cases that the system refused to start: names of files, arguments or devices that it does not
    /// permit.
    pub skipped: usize,
    /// The longest time of a command, and the number of its case.
    pub longest: (Duration, u64),
    /// A description of each case that breaks a rule, with the folder in which it can be repeated.
    pub violations: Vec<String>,
}

/// A case and the answer of the command.
struct Trial {
    /// The case.
    case: Case,
    /// The answer, the second one if the case continues a sweep.
    answer: Answer,
    /// The table of the sweep with which the second command began.
    table: Option<Vec<u8>>,
    /// The broken rules.
    violations: Vec<String>,
}

/// Runs the cases of a series whose numbers `next` returns, until it returns `None`. `make` makes the case with a
/// number. A case that breaks a rule is written into the folder `kept`, under the name of the series and its number.
pub(crate) fn run_cases(
    series: &str,
    make: &(dyn Fn(u64) -> Case + Sync),
    kept: &Path,
    next: &(dyn Fn() -> Option<u64> + Sync),
) -> Summary {
    let summary = Mutex::new(Summary::default());
    thread::scope(|scope| {
        for _ in 0..THREADS {
            scope.spawn(|| {
                while let Some(number) = next() {
                    let trial = Trial::new(make(number));
                    summary.lock().unwrap().add(trial, number, &kept.join(format!("{series}-{number}")));
                }
            });
        }
    });
    summary.into_inner().unwrap()
}

impl Summary {
    /// Adds a trial, and writes it into a folder if it breaks a rule.
    fn add(&mut self, trial: io::Result<Trial>, number: u64, folder: &Path) {
        self.cases += 1;
        let Ok(trial) = trial else {
            self.skipped += 1;
            return;
        };
        let [accepted, all] = self.commands.entry(trial.case.arguments[0].clone()).or_default();
        *accepted += usize::from(trial.answer.code == Some(0));
        *all += 1;
        self.longest = self.longest.max((trial.answer.time, number));
        if !trial.violations.is_empty() {
            let place = match trial.write(folder) {
                Ok(()) => folder.display().to_string(),
                Err(error) => format!("not written: {error}"),
            };
            let what = trial.violations.join(", ");
            let violation = format!("case {number}: patchcord {} {what} ({place})", trial.case.arguments[0]);
            println!("{violation}");
            self.violations.push(violation);
        }
    }
}

impl Trial {
    /// Runs a case in a new folder.
    ///
    /// # Errors
    /// If the system refuses the name of a file or an argument.
    fn new(case: Case) -> io::Result<Trial> {
        let folder = TempDir::new().unwrap();
        case.write(folder.path())?;
        let answer = run(folder.path(), &case)?;
        let violations = violations(&case, folder.path(), &answer);
        let damage_seed = case.damage_seed.filter(|_| answer.code == Some(0));
        let trial = Trial { case, answer, table: None, violations };
        Ok(match damage_seed {
            Some(seed) => trial.continue_sweep(folder.path(), seed),
            None => trial,
        })
    }

    /// Damages the table of a sweep and runs the command again. A missing table is a broken rule already.
    fn continue_sweep(self, folder: &Path, seed: u64) -> Trial {
        let path = folder.join(SWEEP);
        let Ok(whole) = fs::read(&path) else { return self };
        let table = DamagedTable::new(whole, seed);
        fs::write(&path, &table.damaged).unwrap();
        let answer = run(folder, &self.case).unwrap();
        // A missing table counts as an empty one.
        let found = fs::read(&path).unwrap_or_default();
        let fault = table.fault(&found, answer.code == Some(0)).map(str::to_owned);
        let mut broken = self.violations;
        // A refused table is as damaged as before, so only an accepted one is examined.
        if answer.code == Some(0) || answer.broken_limit.is_some() {
            broken.extend(violations(&self.case, folder, &answer));
        } else {
            broken.extend(answer_violations(&self.case, &answer));
        }
        broken.extend(fault);
        Trial { case: self.case, answer, table: Some(table.damaged), violations: broken }
    }

    /// Writes the case into a new folder, with a file that describes how to repeat it.
    fn write(&self, folder: &Path) -> io::Result<()> {
        // An earlier case may have left pipes, which cannot be overwritten.
        if folder.exists() {
            fs::remove_dir_all(folder)?;
        }
        fs::create_dir_all(folder)?;
        self.case.write(folder)?;
        if let Some(table) = &self.table {
            fs::write(folder.join(SWEEP), table)?;
        }
        fs::write(folder.join(DESCRIPTION), self.description(folder))
    }

    /// The command line for a shell, the broken rules, and the messages of the command.
    fn description(&self, folder: &Path) -> String {
        let words: String = self.case.arguments.iter().map(|word| format!(" {}", quoted(word))).collect();
        let ([before, after], output) = (self.case.input.shell_texts(), self.case.output.shell_text());
        format!(
            "cd {}\n{before}patchcord{words}{after}{output}\n\n{}\nexit code {:?} after {:.1} s\n\n{}",
            quoted(&folder.display().to_string()),
            self.violations.join("\n"),
            self.answer.code,
            self.answer.time.as_secs_f64(),
            String::from_utf8_lossy(&self.answer.errors)
        )
    }
}
