//! What was found of cases, kept in a file, a line each, so that a search of all of them may be broken off and taken up again.

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use crate::Outcome;
use crate::hidden::Hidden;
use crate::judged::{Judged, Judgement, Parameter};

/// Cases that were searched, and the file to which others are added.
pub struct Journal {
    pub judged: Vec<Judged>,
    file: Option<File>,
}

impl Journal {
    pub fn read(path: Option<&Path>, hidden: &Hidden) -> Outcome<Journal> {
        let Some(path) = path else { return Ok(Journal { judged: Vec::new(), file: None }) };
        let text = if path.exists() { std::fs::read_to_string(path)? } else { String::new() };
        let judged = text.lines().map(|line| judged(&serde_json::from_str(line)?, hidden));
        let judged = judged.collect::<Outcome<_>>()?;
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        Ok(Journal { judged, file: Some(file) })
    }

    pub fn add(&mut self, one: Judged) -> Outcome<()> {
        if let Some(file) = &mut self.file {
            // In one piece, so that what is broken off leaves no half of a line.
            file.write_all(format!("{}\n", line(&one)).as_bytes())?;
        }
        self.judged.push(one);
        Ok(())
    }

    /// Forgets what was searched.
    pub fn begin_anew(&mut self) -> Outcome<()> {
        self.judged.clear();
        Ok(self.file.iter().try_for_each(|file| file.set_len(0))?)
    }

    /// All of it, in the order of the cases that it has.
    pub fn text(&self) -> String {
        self.judged.iter().map(|one| format!("{}\n", line(one))).collect()
    }
}

fn line(one: &Judged) -> Value {
    let parameters =
        one.parameters.iter().map(|own| json!([own.effect, own.name, own.wanted, own.found, own.interval]));
    json!({
        "number": one.number,
        "hidden": one.truth.what,
        "gap_over_noise": one.truth.egnr,
        "verdict": one.verdict,
        "named": one.named,
        "judgement": one.judgement.as_str(),
        "parameters": parameters.collect::<Vec<_>>(),
        "held_out": one.held_out,
        "seconds": one.seconds,
    })
}

fn judged(line: &Value, hidden: &Hidden) -> Outcome<Judged> {
    let word = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let number = line["number"].as_u64().ok_or("a line of the journal has no number")? as usize;
    let list = |name: &str| line[name].as_array().into_iter().flatten();
    let judgement = Judgement::ALL.into_iter().find(|own| line["judgement"] == own.as_str());
    let truth = hidden.truth(number)?;
    if line["hidden"] != truth.what.as_str() {
        return Err(
            format!("case {number} of the journal is of another seed: it hides {}", line["hidden"]).into()
        );
    }
    Ok(Judged {
        number,
        truth,
        verdict: word(&line["verdict"]),
        named: list("named").map(|own| (word(&own[0]), word(&own[1]))).collect(),
        judgement: judgement.ok_or("a line of the journal has no judgement")?,
        parameters: list("parameters")
            .map(|own| Parameter {
                effect: word(&own[0]),
                name: word(&own[1]),
                wanted: own[2].as_f64().unwrap_or(f64::NAN),
                found: own[3].as_f64().unwrap_or(f64::NAN),
                interval: [
                    own[4][0].as_f64().unwrap_or(f64::NEG_INFINITY),
                    own[4][1].as_f64().unwrap_or(f64::INFINITY),
                ],
            })
            .collect(),
        held_out: line["held_out"].as_f64().unwrap_or(f64::INFINITY),
        seconds: line["seconds"].as_f64().unwrap_or_default(),
        tried: String::new(),
    })
}
