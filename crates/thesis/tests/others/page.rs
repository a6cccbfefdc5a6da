//! docs/others.md: its tables, and what its text takes from them.

use crate::common::pages::{check_part, check_told};
use crate::others::bench::{BRAKE, Even, FRICTION, NAKASHIMA, shipped};
use crate::others::nakashima::SET;
use crate::others::points::{Counts, SLOW, by_a_ramp, slowed};
use crate::others::{lag_last, relays, singh};
use patchcord_thesis::slideway::falling::FallingFriction;
use patchcord_thesis::slideway::stability::DrivenTable;

const PAGE: &str = "docs/others.md";

fn row(cells: &[String]) -> String {
    format!("| {} |\n", cells.join(" | "))
}

fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let head: Vec<_> = head.iter().map(|cell| (*cell).to_owned()).collect();
    let rows: String = rows.map(|cells| row(&cells)).collect();
    format!("{}{}|\n{rows}", row(&head), "|---".repeat(head.len()))
}

/// In mm/s, without a trace of rounding.
fn millimetres(velocity: f64, digits: usize) -> String {
    let text = format!("{:.digits$}", velocity * 1e3);
    if text.trim_start_matches('-').bytes().all(|byte| b"0.".contains(&byte)) { "0".to_owned() } else { text }
}

fn span(even: &Even) -> String {
    format!("{} ... {}", millimetres(even.least(), 2), millimetres(even.most(), 2))
}

fn per_cent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// What of a run at an even command stands in a table.
fn cells(even: &Even) -> [String; 3] {
    [per_cent(even.stands()), format!("{:.1}", even.slips_per_second()), span(even)]
}

fn set_table() -> String {
    let rows = SET.into_iter().map(|command| {
        let relays = Even::set(&shipped(NAKASHIMA), &[], command);
        let brake = Even::commanded(&shipped(BRAKE), command);
        [vec![millimetres(command, 1)], cells(&relays).to_vec(), vec![span(&brake)]].concat()
    });
    let head = ["set velocity, mm/s", "stands still", "cycles per s", "v_o, mm/s", "v_o with a brake, mm/s"];
    table(&head, rows)
}

fn counts_table() -> String {
    let both = Counts::both();
    let counted = |what: &str, count: &dyn Fn(&Counts) -> usize| {
        [vec![what.to_owned()], both.iter().map(|counts| count(counts).to_string()).collect()].concat()
    };
    let rows = [
        counted("summing and integrating amplifiers", &Counts::amplifiers),
        counted("multipliers", &|counts| counts.of(&["multiplier"])),
        counted("of these electronic potentiometers", &Counts::electronic_pots),
        counted("function generators", &|counts| counts.of(&["function-generator"])),
        counted("relays", &|counts| counts.of(&["relay"])),
        counted("amplifiers with those inside of these", &Counts::amplifiers_inside),
        counted("places where the output velocity goes in", &Counts::inputs_of_velocity),
        counted("settings in which M stands", &|counts| counts.settings_of("M")),
        counted("settings in which f stands", &|counts| counts.settings_of("f")),
    ];
    table(&["", "Nakashima", "Fig 8.16"], rows.into_iter())
}

fn slow_table() -> String {
    let rows = SLOW.into_iter().map(|time| {
        let [low, high] = [1e-3, 9e-3].map(|command| slowed(time, command));
        let lag = if time == 0.0 { "none".to_owned() } else { format!("{} µs", time * 1e6) };
        [vec![lag], [&low[0], &low[1], &high[0], &high[1]].map(span).to_vec()].concat()
    });
    let head = [
        "lag of every multiplier",
        "Nakashima at 1 mm/s",
        "Fig 8.16 with a brake",
        "Nakashima at 9 mm/s",
        "Fig 8.16 with a brake",
    ];
    table(&head, rows)
}

fn relays_table() -> String {
    let rows =
        relays::faults().into_iter().map(|(fault, even)| [vec![fault], cells(&even).to_vec()].concat());
    table(&["what is wrong with the relays", "stands still", "cycles per s", "v_o, mm/s"], rows)
}

fn singh_table() -> String {
    let rows = singh::FALLING.into_iter().map(|falling| {
        let swings = singh::grid(falling);
        let count = |holds: fn(&singh::Swing) -> bool| swings.iter().filter(|swing| holds(swing)).count();
        let ends = [count(singh::Swing::dies_away), count(singh::Swing::grows_into_overload)];
        let neither = swings.len() - ends.iter().sum::<usize>();
        vec![format!("{falling} f"), ends[0].to_string(), ends[1].to_string(), neither.to_string()]
    });
    table(&["n", "dies away", "grows until an amplifier is overloaded", "goes on"], rows)
}

fn critical_table() -> String {
    let rows = [0.0, 2.5e3, 5e3, 8e3].into_iter().map(|falling| {
        let theory = singh::by_theory(falling);
        let velocities = [
            singh::critical(falling),
            theory.critical_velocity().unwrap(),
            theory.approximate_critical_velocity().unwrap(),
        ];
        [vec![format!("{:.1}", falling / 1e3)], velocities.map(|velocity| millimetres(velocity, 3)).to_vec()]
            .concat()
    });
    table(&["n, kN s/m", "circuit, mm/s", "eq 18.2 touches 0, mm/s", "eq 19.2, mm/s"], rows)
}

fn lag_table() -> String {
    let rows = lag_last::SETTINGS.into_iter().map(|(vcl, tc)| {
        let [(rising, falling), (later, same)] = lag_last::critical(vcl, tc);
        let more = format!("{:.1} %", 100.0 * (later / rising - 1.0));
        let velocities = [rising, later].map(|velocity| millimetres(velocity, 2));
        let begins = [falling, same].map(|velocity| millimetres(velocity, 2));
        let setting = [millimetres(vcl, 2), format!("{:.1}", tc * 1e3)];
        [&setting[..], &velocities, &[more], &begins].concat()
    });
    let head = [
        "VcL, mm/s",
        "Tc, ms",
        "rising, oscillation ends, mm/s",
        "lag last",
        "later by",
        "falling, it begins, mm/s",
        "lag last",
    ];
    table(&head, rows)
}

#[test]
#[ignore = "takes ten seconds"]
fn the_page_tells_what_is_measured() {
    let parts = [
        ("singh", singh_table()),
        ("critical", critical_table()),
        ("set", set_table()),
        ("counts", counts_table()),
        ("slow", slow_table()),
        ("relays", relays_table()),
        ("lag-last", lag_table()),
    ];
    for (mark, fresh) in parts {
        check_part(PAGE, mark, &fresh, "patchcord-thesis");
    }
    check_told(
        PAGE,
        &[
            format!("at {} mm/s, while the command rises", millimetres(by_a_ramp(), 2)),
            format!("die away above {} mm/s, by Routh", millimetres(boundary(), 2)),
            lag_sentence(),
            damping_sentence(),
        ],
    );
}

/// What two slow multipliers take of the damping ratio, what viscous friction gives, and what falling friction leaves of that.
fn damping_sentence() -> String {
    let table = DrivenTable::simulated(0.0065);
    let (frequency, viscous) = (table.natural_frequency().unwrap(), table.damping_ratio().unwrap());
    let [(_, solid), (_, vcl)] = FRICTION;
    let slope = 2.0 * solid * (vcl - 9e-3) / (vcl * vcl);
    // This share of what follows with the lag Tc is in phase with the velocity.
    let in_phase = 1.0 / (1.0 + (frequency * table.memory).powi(2));
    let left = viscous * (1.0 - slope * in_phase / table.damping);
    // Each lag takes half of its angle at the natural frequency.
    let taken = 2.0 * 0.5 * frequency * SLOW[1];
    let gives = format!(
        "Viscous friction gives {viscous:.3}, and at 9 mm/s falling friction leaves {left:.3} of that"
    );
    format!("a damping ratio of {taken:.3}. {gives}")
}

/// The command above which small motions of Nakashima's slideway die away, in m/s.
fn boundary() -> f64 {
    let [(_, solid), (_, vcl)] = FRICTION;
    let friction = FallingFriction { static_friction: solid, limit: vcl };
    DrivenTable::simulated(0.0065).critical_velocity(&friction).unwrap()
}

/// How much longer oscillation goes on at VcL = 2.54 mm/s with the lag last.
fn lag_sentence() -> String {
    let steep = lag_last::SETTINGS.into_iter().filter(|(vcl, _)| *vcl == 2.54e-3);
    let more = steep.map(|(vcl, tc)| {
        let [(rising, _), (last, _)] = lag_last::critical(vcl, tc);
        100.0 * (last / rising - 1.0)
    });
    let [least, most] = more.fold([f64::MAX, 0.0], |[least, most], more| [least.min(more), most.max(more)]);
    format!("for {least:.0} to {most:.0} % longer")
}
