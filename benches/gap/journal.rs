//! The journal: a file with one JSON line per searched case. It permits to interrupt and to continue a run of the
//! benchmark.

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use crate::Outcome;
use crate::case_result::{CaseResult, Judgement, ParameterEstimate};
use crate::hidden_cases::HiddenCases;

/// The results of searched cases, and the file to which further results are appended.
pub(crate) struct Journal {
    /// In the order of the file, until the caller sorts them.
    pub results: Vec<CaseResult>,
    /// `None` if the results are not kept.
    file: Option<File>,
}

impl Journal {
    /// Reads a journal, or begins an empty one if the file does not exist. Without a path nothing is written.
    ///
    /// # Errors
    ///
    /// If the file cannot be read or appended to, if a line is invalid, or if it belongs to cases of another seed.
    pub(crate) fn read(path: Option<&Path>, cases: &HiddenCases) -> Outcome<Journal> {
        let Some(path) = path else { return Ok(Journal { results: Vec::new(), file: None }) };
        let text = if path.exists() { std::fs::read_to_string(path)? } else { String::new() };
        let results = text.lines().map(|line| result_of(&serde_json::from_str(line)?, cases));
        let results = results.collect::<Outcome<_>>()?;
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        Ok(Journal { results, file: Some(file) })
    }

    /// Appends a result.
    pub(crate) fn add(&mut self, result: CaseResult) -> Outcome<()> {
        if let Some(file) = &mut self.file {
            // One write per line, so that an interruption leaves no incomplete line.
            file.write_all(format!("{}\n", line_of(&result)).as_bytes())?;
        }
        self.results.push(result);
        Ok(())
    }

    /// Discards all results, in the file too.
    pub(crate) fn clear(&mut self) -> Outcome<()> {
        self.results.clear();
        Ok(self.file.iter().try_for_each(|file| file.set_len(0))?)
    }

    /// The text of the file, with the results in their present order.
    pub(crate) fn text(&self) -> String {
        self.results.iter().map(|result| format!("{}\n", line_of(result))).collect()
    }
}

/// The JSON line of a result. Scripts and tests read its keys.
fn line_of(result: &CaseResult) -> Value {
    let parameters = result.parameters.iter().map(|estimate| {
        json!([estimate.effect, estimate.name, estimate.truth, estimate.fitted, estimate.interval])
    });
    json!({
        "number": result.number,
        "hidden": result.truth.what,
        "gap_over_noise": result.truth.egnr,
        "verdict": result.verdict,
        "named": result.named,
        "judgement": result.judgement.as_str(),
        "parameters": parameters.collect::<Vec<_>>(),
        "held_out": result.validation_residual,
        "seconds": result.seconds,
    })
}

/// The result of a JSON line. The truth is read from the case itself.
fn result_of(line: &Value, cases: &HiddenCases) -> Outcome<CaseResult> {
    let string = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let number = line["number"].as_u64().ok_or("a line of the journal has no number")? as usize;
    let list = |name: &str| line[name].as_array().into_iter().flatten();
    let judgement = Judgement::ALL.into_iter().find(|judgement| line["judgement"] == judgement.as_str());
    let truth = cases.truth(number)?;
    if line["hidden"] != truth.what.as_str() {
        let hidden = &line["hidden"];
        return Err(format!("case {number} of the journal belongs to another seed: it hides {hidden}").into());
    }
    Ok(CaseResult {
        number,
        truth,
        verdict: string(&line["verdict"]),
        named: list("named").map(|pair| (string(&pair[0]), string(&pair[1]))).collect(),
        judgement: judgement.ok_or("a line of the journal has no judgement")?,
        parameters: list("parameters")
            .map(|cells| ParameterEstimate {
                effect: string(&cells[0]),
                name: string(&cells[1]),
                truth: cells[2].as_f64().unwrap_or(f64::NAN),
                fitted: cells[3].as_f64().unwrap_or(f64::NAN),
                interval: [
                    cells[4][0].as_f64().unwrap_or(f64::NEG_INFINITY),
                    cells[4][1].as_f64().unwrap_or(f64::INFINITY),
                ],
            })
            .collect(),
        validation_residual: line["held_out"].as_f64().unwrap_or(f64::INFINITY),
        seconds: line["seconds"].as_f64().unwrap_or_default(),
        search_log: String::new(),
    })
}
