//! How to run, read off the tree of the text: times, or phases.

use super::document::RunPlan;
use crate::document::fields::{Fields, Findings, flag, list, positive, word, wrong_type};
use crate::document::tree::{Content, Node};
use crate::document::{
    Change, Code, Diagnostic, Extent, LEAST_TOLERANCE, Phase, Placed, Span, Until, formula, suggestion, told,
};

pub(super) fn run(node: &Node, findings: &mut Findings) -> RunPlan {
    let Some(mut fields) = Fields::of(node, "\"run\"", findings) else { return RunPlan::default() };
    let mut plan = RunPlan {
        duration: positive(&mut fields, "for", findings),
        step: positive(&mut fields, "step", findings),
        tolerance: tolerance(&mut fields, findings),
        every: positive(&mut fields, "every", findings),
        repeat: whole(&mut fields, "repeat", "runs", findings),
        hold_on_overload: fields
            .take("hold_on_overload")
            .and_then(|node| flag(node, "hold_on_overload", findings))
            .unwrap_or(false),
        phases: Vec::new(),
    };
    let errors = findings.len();
    if let Some((key_span, node)) = fields.take_with_key("phases") {
        one_way_of_length(&plan, findings);
        plan.phases = phases(key_span, node, findings);
        if findings.len() == errors && Extent::of(&plan.phases).recorded == 0.0 {
            findings.push(timeless(key_span));
        }
    }
    if findings.len() == errors {
        shorter_than_run(&plan, findings);
    }
    fields.text("note", findings);
    fields.finish(findings);
    plan
}

fn tolerance(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Placed<f64>> {
    let share = positive(fields, "tolerance", findings)?;
    if share.value < LEAST_TOLERANCE {
        let message = format!("\"tolerance\" must be {LEAST_TOLERANCE:e} or more, not {:e}", share.value);
        let hint = "the rounding of numbers is no smaller";
        findings.push(Diagnostic::at(Code::BadNumber, share.span, message).hint(hint));
        return None;
    }
    Some(share)
}

/// Phases say how long the run is: nothing else may.
fn one_way_of_length(plan: &RunPlan, findings: &mut Findings) {
    let hints = [
        ("for", &plan.duration, "write {\"operate\": seconds} among the phases instead"),
        ("repeat", &plan.repeat, "write {\"repeat\": times, \"phases\": [...]} among the phases instead"),
    ];
    for (key, given, hint) in hints {
        if let Some(given) = given {
            let message = format!("\"{key}\" stands beside \"phases\", which say how long the run is");
            findings.push(Diagnostic::at(Code::ExcludingKeys, given.span, message).hint(hint));
        }
    }
}

fn timeless(span: Span) -> Diagnostic {
    Diagnostic::at(Code::MissingKey, span, "no phase takes any time").hint("write {\"operate\": seconds}")
}

fn shorter_than_run(plan: &RunPlan, findings: &mut Findings) {
    let Some(phases) = plan.all_phases() else { return };
    let run = Extent::of(&phases).longest;
    for (key, time) in [("step", &plan.step), ("every", &plan.every)] {
        if let Some(time) = time.as_ref().filter(|time| time.value > run) {
            let message =
                format!("\"{key}\" is {} s, longer than the run of {} s", told(time.value), told(run));
            findings.push(Diagnostic::at(Code::BadNumber, time.span, message));
        }
    }
}

/// A number of times.
fn whole(
    fields: &mut Fields<'_>,
    key: &'static str,
    of_what: &str,
    findings: &mut Findings,
) -> Option<Placed<f64>> {
    let times = positive(fields, key, findings)?;
    if times.value.fract() != 0.0 {
        let message = format!("\"{key}\" is a whole number of {of_what}");
        findings.push(Diagnostic::at(Code::BadNumber, times.span, message));
        return None;
    }
    Some(times)
}

/// The list under the key "phases".
fn phases(key_span: Span, node: &Node, findings: &mut Findings) -> Vec<Phase> {
    let Some(items) = list(node, "phases", findings) else { return Vec::new() };
    if items.is_empty() {
        let hint = "write at least {\"operate\": seconds}, or leave the key out";
        findings.push(Diagnostic::at(Code::MissingKey, key_span, "there is no phase in the list").hint(hint));
    }
    items.iter().filter_map(|item| phase(item, findings)).collect()
}

/// What a phase can do; each phase does one of these.
const DEEDS: [&str; 5] = ["initial_condition", "operate", "hold", "set", "repeat"];

fn phase(node: &Node, findings: &mut Findings) -> Option<Phase> {
    let deed = deed(node, findings)?;
    let mut fields = Fields::of(node, format!("a phase of \"{deed}\""), findings)?;
    let read = match deed {
        "initial_condition" => initial_condition(&mut fields, findings),
        "operate" => operate(&mut fields, findings),
        "hold" => positive(&mut fields, "hold", findings).map(|time| Phase::Hold { time: time.value }),
        "set" => fields.take("set").and_then(|node| set(node, findings)),
        _ => repeat(&mut fields, findings),
    };
    fields.text("note", findings);
    fields.finish(findings);
    read
}

/// The key that says what a phase does: one, and not another beside it.
fn deed(node: &Node, findings: &mut Findings) -> Option<&'static str> {
    let Content::Object(entries) = &node.value else {
        let message = format!("a phase must be an object, not {}", node.value.noun());
        let hint = "write {\"operate\": seconds}, {\"hold\": seconds}, {\"set\": {...}} and so on";
        findings.push(Diagnostic::at(Code::WrongType, node.span, message).hint(hint));
        return None;
    };
    let known = |key: &str| DEEDS.into_iter().find(|deed| *deed == key);
    let mut deeds = entries.iter().filter_map(|entry| Some((known(&entry.key)?, entry.key_span)));
    let Some((deed, _)) = deeds.next() else {
        let (code, span, hint) = match entries.iter().find(|entry| entry.key != "note") {
            Some(entry) => (Code::UnknownKey, entry.key_span, suggestion(&entry.key, &DEEDS)),
            None => (Code::MissingKey, node.span, Some(format!("it takes one of {}", DEEDS.join(", ")))),
        };
        let message = "the phase does not say what the machine does";
        findings.push(Diagnostic::at(code, span, message).maybe_hint(hint));
        return None;
    };
    if let Some((other, span)) = deeds.find(|(other, _)| *other != deed) {
        let message = format!("a phase cannot both \"{deed}\" and \"{other}\"");
        let hint = "write two phases, one after the other";
        findings.push(Diagnostic::at(Code::ExcludingKeys, span, message).hint(hint));
        return None;
    }
    Some(deed)
}

fn initial_condition(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Phase> {
    let node = fields.take("initial_condition")?;
    if !flag(node, "initial_condition", findings)? {
        let message = "\"initial_condition\" is either true or left out";
        findings.push(Diagnostic::at(Code::WrongType, node.span, message).hint("take the phase out"));
    }
    Some(Phase::InitialCondition)
}

fn operate(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Phase> {
    let time = positive(fields, "operate", findings);
    let until = fields.take("until").map(|node| until(node, findings));
    let time = time?.value;
    match until {
        None => Some(Phase::operate(time)),
        Some(until) => Some(Phase::Operate { time, until: Some(until?) }),
    }
}

/// A relay's name, or an object that tells the position too.
fn until(node: &Node, findings: &mut Findings) -> Option<Until> {
    match &node.value {
        Content::Text(_) => word(node, "until", findings).map(|relay| Until { relay, becomes: None }),
        Content::Object(_) => {
            let mut fields = Fields::of(node, "\"until\"", findings)?;
            let relay = fields.need("relay", "the relay that ends the phase");
            let relay = relay.and_then(|node| word(node, "relay", findings));
            let becomes = fields.take("becomes").map(|node| word(node, "becomes", findings));
            fields.finish(findings);
            match becomes {
                None => Some(Until { relay: relay?, becomes: None }),
                Some(becomes) => Some(Until { relay: relay?, becomes: Some(becomes?) }),
            }
        }
        other => {
            let wanted = "the name of a relay, or an object with \"relay\" and \"becomes\"";
            findings.push(wrong_type(node, "until", wanted, other));
            None
        }
    }
}

fn set(node: &Node, findings: &mut Findings) -> Option<Phase> {
    let fields = Fields::of(node, "\"set\"", findings)?;
    let entries: Vec<_> = fields.rest().collect();
    if entries.is_empty() {
        let message = "nothing is set";
        let hint = "write {\"set\": {\"name of a parameter\": value}}";
        findings.push(Diagnostic::at(Code::MissingKey, node.span, message).hint(hint));
    }
    let changes = entries.into_iter().map(|entry| {
        let parameter = Placed { value: entry.key.clone(), span: entry.key_span };
        Some(Change { parameter, to: formula(&entry.value, &entry.key, findings)? })
    });
    changes.collect::<Vec<_>>().into_iter().collect::<Option<_>>().map(|changes| Phase::Set { changes })
}

fn repeat(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Phase> {
    let times = whole(fields, "repeat", "times", findings);
    let phases = match fields.take_with_key("phases") {
        Some((key_span, node)) => Some(phases(key_span, node, findings)),
        None => {
            fields.need("phases", "the list of what is repeated");
            None
        }
    };
    Some(Phase::Repeat { times: times?.value as u64, phases: phases? })
}
