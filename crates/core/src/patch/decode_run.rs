//! Decodes the section "run": times and phases.
//!
//! A run is specified in one of two ways. Either "for" and "repeat" give its length, or "phases" lists what the machine
//! does. Times are in problem seconds. Each phase is an object with one key that names the action, such as
//! `{"operate": 2}`, and the keys that belong to this action.
//!
//! A part that cannot be read is reported and left out. The times are compared with the length of the run only if
//! everything else is correct, because a missing phase would make the run too short.
//!
//! ```text
//! "run": {"for": 8, "step": 0.001, "repeat": 3}
//! "run": {"step": 0.001, "phases": [
//!   {"initial_condition": true},
//!   {"operate": 2, "until": {"relay": "K1", "becomes": "pulled-in"}},
//!   {"set": {"k": "2 * k"}}
//! ]}
//! ```

use super::document::RunPlan;
use super::key_synonyms::run_advice;
use crate::document::fields::{Fields, Findings, flag, list, positive, string, wrong_type};
use crate::document::tree::{Content, Node};
use crate::document::{
    Code, Diagnostic, MAX_TOLERANCE, MIN_TOLERANCE, ParameterChange, Phase, Placed, RunExtent, Span,
    SwitchCondition, format_distinct, format_outside, formula, is_tolerance, suggestion,
};

/// Decodes the section "run". Parts that cannot be read are absent in the plan.
pub(super) fn run(node: &Node, findings: &mut Findings) -> RunPlan {
    let hint = Some("write \"run\": {\"for\": 10, \"step\": 0.01}, with the times in s".to_owned());
    let Some(mut fields) = Fields::of_with_hint(node, "\"run\"", hint, findings) else {
        return RunPlan::default();
    };
    let mut plan = RunPlan {
        duration: positive(&mut fields, "for", findings),
        step: positive(&mut fields, "step", findings),
        tolerance: tolerance(&mut fields, findings),
        every: positive(&mut fields, "every", findings),
        repeat: whole_number(&mut fields, "repeat", "runs", findings),
        hold_on_overload: fields
            .take("hold_on_overload")
            .and_then(|node| flag(node, "hold_on_overload", findings))
            .unwrap_or(false),
        phases: Vec::new(),
    };
    let findings_before = findings.len();
    if let Some((key_span, node)) = fields.take_with_key("phases") {
        check_length_keys(&plan, findings);
        plan.phases = phases(key_span, node, findings);
        if findings.len() == findings_before && RunExtent::of(&plan.phases).record_time == 0.0 {
            findings.push(zero_length(key_span));
        }
    }
    if findings.len() == findings_before {
        check_times_within_run(&plan, findings);
    }
    fields.text("note", findings);
    fields.finish_with_advice(&run_advice, findings);
    plan
}

/// Decodes the tolerance. It must be from `MIN_TOLERANCE` to `MAX_TOLERANCE`.
fn tolerance(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Placed<f64>> {
    let tolerance = positive(fields, "tolerance", findings)?;
    if is_tolerance(tolerance.value) {
        return Some(tolerance);
    }
    let value = format_outside(tolerance.value, (MIN_TOLERANCE, MAX_TOLERANCE));
    let [least, most] = [MIN_TOLERANCE, MAX_TOLERANCE].map(|bound| format_distinct(bound, tolerance.value));
    let message = format!("\"tolerance\" must be from {least} to {most}, not {value}");
    let hint = match tolerance.value > MAX_TOLERANCE {
        true => "it is a share of 100 V, such as 1e-6",
        false => "rounding errors are as large as that",
    };
    findings.push(Diagnostic::at(Code::BAD_NUMBER, tolerance.span, message).hint(hint));
    None
}

/// Reports "for" and "repeat" in a run with phases, because the phases specify the length of the run.
fn check_length_keys(plan: &RunPlan, findings: &mut Findings) {
    let hints = [
        ("for", &plan.duration, "write {\"operate\": seconds} among the phases instead"),
        ("repeat", &plan.repeat, "write {\"repeat\": times, \"phases\": [...]} among the phases instead"),
    ];
    for (key, value, hint) in hints {
        if let Some(value) = value {
            let message = format!("\"{key}\" and \"phases\" both specify the length of the run");
            findings.push(Diagnostic::at(Code::EXCLUDING_KEYS, value.span, message).hint(hint));
        }
    }
}

/// The error for phases that neither operate nor hold: they record nothing.
fn zero_length(span: Span) -> Diagnostic {
    Diagnostic::at(Code::MISSING_KEY, span, "no phase takes any time").hint("write {\"operate\": seconds}")
}

/// Reports a step or a recording interval that is longer than the longest phase.
///
/// A run is as long as its longest repetition here: a longer step or interval would give a single sample.
fn check_times_within_run(plan: &RunPlan, findings: &mut Findings) {
    let Some(phases) = plan.all_phases() else { return };
    let longest = RunExtent::of(&phases).longest_repetition;
    for (key, time) in [("step", &plan.step), ("every", &plan.every)] {
        if let Some(time) = time.as_ref().filter(|time| time.value > longest) {
            let message = format!(
                "\"{key}\" is {} s, longer than the run of {} s",
                format_distinct(time.value, longest),
                format_distinct(longest, time.value)
            );
            findings.push(Diagnostic::at(Code::BAD_NUMBER, time.span, message));
        }
    }
}

/// Decodes an optional whole number above 0. `noun` says what is counted, for the message.
fn whole_number(
    fields: &mut Fields<'_>,
    key: &'static str,
    noun: &str,
    findings: &mut Findings,
) -> Option<Placed<f64>> {
    let count = positive(fields, key, findings)?;
    if count.value.fract() != 0.0 {
        let message = format!("\"{key}\" must be a whole number of {noun}");
        findings.push(Diagnostic::at(Code::BAD_NUMBER, count.span, message));
        return None;
    }
    Some(count)
}

/// Decodes the list under a key "phases": that of the run or that of a repeated phase. It must not be empty.
fn phases(key_span: Span, node: &Node, findings: &mut Findings) -> Vec<Phase> {
    let Some(items) = list(node, "phases", findings) else { return Vec::new() };
    if items.is_empty() {
        let hint = "write at least {\"operate\": seconds}, or remove the key";
        findings.push(Diagnostic::at(Code::MISSING_KEY, key_span, "the list of phases is empty").hint(hint));
    }
    items.iter().filter_map(|item| phase(item, findings)).collect()
}

/// The keys that name the action of a phase. Every phase has exactly one of them.
const ACTION_KEYS: [&str; 5] = ["initial_condition", "operate", "hold", "set", "repeat"];

/// Decodes one phase. `None` after a report.
///
/// The action decides which other keys are permitted, so it is found first.
fn phase(node: &Node, findings: &mut Findings) -> Option<Phase> {
    let action = action_key(node, findings)?;
    let mut fields = Fields::of(node, format!("a phase of \"{action}\""), findings)?;
    let phase = match action {
        "initial_condition" => initial_condition(&mut fields, findings),
        "operate" => operate(&mut fields, findings),
        "hold" => positive(&mut fields, "hold", findings).map(|time| Phase::Hold { time: time.value }),
        "set" => fields.take("set").and_then(|node| set(node, findings)),
        _ => repeat(&mut fields, findings),
    };
    fields.text("note", findings);
    fields.finish(findings);
    phase
}

/// Finds the key that names the action of a phase. Reports a phase with no such key or with two.
///
/// Other keys are judged later, against the action. Only "note" is permitted with every action.
fn action_key(node: &Node, findings: &mut Findings) -> Option<&'static str> {
    let Content::Object(entries) = &node.value else {
        let message = format!("a phase must be an object, not {}", node.value.noun());
        let hint = "write {\"operate\": seconds}, {\"hold\": seconds}, {\"set\": {...}} and so on";
        findings.push(Diagnostic::at(Code::WRONG_TYPE, node.span, message).hint(hint));
        return None;
    };
    let known_action = |key: &str| ACTION_KEYS.into_iter().find(|action| *action == key);
    let mut actions = entries.iter().filter_map(|entry| Some((known_action(&entry.key)?, entry.key_span)));
    let Some((action, _)) = actions.next() else {
        let (code, span, hint) = match entries.iter().find(|entry| entry.key != "note") {
            Some(entry) => (Code::UNKNOWN_KEY, entry.key_span, suggestion(&entry.key, &ACTION_KEYS)),
            None => (Code::MISSING_KEY, node.span, Some(format!("write one of {}", ACTION_KEYS.join(", ")))),
        };
        let message = "the phase has no action";
        findings.push(Diagnostic::at(code, span, message).maybe_hint(hint));
        return None;
    };
    if let Some((other, span)) = actions.find(|(other, _)| *other != action) {
        let message = format!("a phase cannot both \"{action}\" and \"{other}\"");
        let hint = "write two phases, one after the other";
        findings.push(Diagnostic::at(Code::EXCLUDING_KEYS, span, message).hint(hint));
        return None;
    }
    Some(action)
}

/// Decodes `{"initial_condition": true}`.
fn initial_condition(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Phase> {
    let node = fields.take("initial_condition")?;
    if !flag(node, "initial_condition", findings)? {
        let message = "\"initial_condition\" must be true or absent";
        findings.push(Diagnostic::at(Code::WRONG_TYPE, node.span, message).hint("remove the phase"));
    }
    Some(Phase::InitialCondition)
}

/// Decodes `{"operate": seconds, "until": relay}`; "until" is optional.
fn operate(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Phase> {
    let time = positive(fields, "operate", findings);
    let until = fields.take("until").map(|node| until(node, findings));
    let time = time?.value;
    match until {
        None => Some(Phase::operate(time)),
        Some(until) => Some(Phase::Operate { time, until: Some(until?) }),
    }
}

/// Decodes the relay that ends a phase: its name, or an object with the relay and the position to which it switches.
fn until(node: &Node, findings: &mut Findings) -> Option<SwitchCondition> {
    match &node.value {
        Content::Text(_) => {
            string(node, "until", findings).map(|relay| SwitchCondition { relay, becomes: None })
        }
        Content::Object(_) => {
            let mut fields = Fields::of(node, "\"until\"", findings)?;
            let relay = fields.require("relay", "the relay that ends the phase");
            let relay = relay.and_then(|node| string(node, "relay", findings));
            let becomes = fields.take("becomes").map(|node| string(node, "becomes", findings));
            fields.finish(findings);
            match becomes {
                None => Some(SwitchCondition { relay: relay?, becomes: None }),
                Some(becomes) => Some(SwitchCondition { relay: relay?, becomes: Some(becomes?) }),
            }
        }
        other => {
            let expected = "the name of a relay, or an object with \"relay\" and \"becomes\"";
            findings.push(wrong_type(node, "until", expected, other));
            None
        }
    }
}

/// Decodes `{"set": {parameter: formula}}`. If one formula cannot be read, the whole phase is absent.
///
/// All formulas are decoded before the result is judged, so every fault of the phase is reported.
fn set(node: &Node, findings: &mut Findings) -> Option<Phase> {
    let fields = Fields::of(node, "\"set\"", findings)?;
    let entries: Vec<_> = fields.remaining().collect();
    if entries.is_empty() {
        let message = "the phase sets no parameter";
        let hint = "write {\"set\": {\"name of a parameter\": value}}";
        findings.push(Diagnostic::at(Code::MISSING_KEY, node.span, message).hint(hint));
    }
    let changes = entries.into_iter().map(|entry| {
        let parameter = Placed { value: entry.key.clone(), span: entry.key_span };
        Some(ParameterChange { parameter, to: formula(&entry.value, &entry.key, findings)? })
    });
    changes.collect::<Vec<_>>().into_iter().collect::<Option<_>>().map(|changes| Phase::Set { changes })
}

/// Decodes `{"repeat": times, "phases": [...]}`.
fn repeat(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<Phase> {
    let times = whole_number(fields, "repeat", "times", findings);
    let phases = match fields.take_with_key("phases") {
        Some((key_span, node)) => Some(phases(key_span, node, findings)),
        None => {
            fields.require("phases", "the list of phases to repeat");
            None
        }
    };
    Some(Phase::Repeat { times: times?.value as u64, phases: phases? })
}
