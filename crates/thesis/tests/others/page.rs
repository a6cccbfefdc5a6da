//! The tables of docs/others.md, and the sentences that quote them.

use crate::common::pages::{assert_page_contains, assert_part_up_to_date};
use crate::others::nakashima::SET;
use crate::others::nakashima_points::{Counts, SLOW, critical_velocity_by_ramp, slowed};
use crate::others::steady_run::{BRAKE, FRICTION, NAKASHIMA, SteadyRun, shipped};
use crate::others::{lag_last, relays, singh};
use crate::velocity_readings::{self, format_fixed};
use patchcord_thesis::slideway::falling::FallingFriction;
use patchcord_thesis::slideway::stability::DrivenTable;

/// The page with these tables.
const PAGE: &str = "docs/others.md";

/// A row of a Markdown table.
fn row(cells: &[String]) -> String {
    format!("| {} |\n", cells.join(" | "))
}

/// A Markdown table.
fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let head: Vec<_> = head.iter().map(|cell| (*cell).to_owned()).collect();
    let rows: String = rows.map(|cells| row(&cells)).collect();
    format!("{}{}|\n{rows}", row(&head), "|---".repeat(head.len()))
}

/// A velocity in mm/s, with a number of decimals.
fn millimetres(velocity: f64, decimals: usize) -> String {
    format_fixed(velocity * 1e3, decimals)
}

/// The minimum and the maximum velocity of a run.
fn span(run: &SteadyRun) -> String {
    format!("{} ... {}", millimetres(run.min(), 2), millimetres(run.max(), 2))
}

/// A share in percent, without decimals.
fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// The cells of a run at a steady command: share at rest, cycles per second, range of velocity.
fn cells(run: &SteadyRun) -> [String; 3] {
    [percent(run.rest_share()), format!("{:.1}", run.slips_per_second()), span(run)]
}

/// The table of set velocities: stick-slip of Nakashima's circuit, and of Fig 8.16 with a brake.
fn set_table() -> String {
    let rows = SET.into_iter().map(|command| {
        let relays = SteadyRun::set(&shipped(NAKASHIMA), &[], command);
        let brake = SteadyRun::commanded(&shipped(BRAKE), command);
        [vec![millimetres(command, 1)], cells(&relays).to_vec(), vec![span(&brake)]].concat()
    });
    let head = ["set velocity, mm/s", "at rest", "cycles per s", "v_o, mm/s", "v_o with a brake, mm/s"];
    table(&head, rows)
}

/// The table of counted parts of both circuits.
fn counts_table() -> String {
    let both = Counts::both();
    let counted = |what: &str, count: &dyn Fn(&Counts) -> usize| {
        [vec![what.to_owned()], both.iter().map(|counts| count(counts).to_string()).collect()].concat()
    };
    let rows = [
        counted("summing and integrating amplifiers", &Counts::amplifiers),
        counted("multipliers", &|counts| counts.of(&["multiplier"])),
        counted("multipliers as electronic potentiometers", &Counts::electronic_pots),
        counted("function generators", &|counts| counts.of(&["function-generator"])),
        counted("relays", &|counts| counts.of(&["relay"])),
        counted("amplifiers including those inside these parts", &Counts::amplifiers_inside),
        counted("inputs of the output velocity", &Counts::inputs_of_velocity),
        counted("settings that contain M", &|counts| counts.settings_of("M")),
        counted("settings that contain f", &|counts| counts.settings_of("f")),
    ];
    table(&["", "Nakashima", "Fig 8.16"], rows.into_iter())
}

/// The table of slow multipliers.
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

/// The table of relay faults.
fn relays_table() -> String {
    let rows = relays::faults().into_iter().map(|(fault, run)| [vec![fault], cells(&run).to_vec()].concat());
    table(&["fault of the relays", "at rest", "cycles per s", "v_o, mm/s"], rows)
}

/// The table of Singh's circuit: the number of runs that decay, grow or continue.
fn singh_table() -> String {
    let rows = singh::FALLING.into_iter().map(|falling| {
        let swings = singh::grid(falling);
        let count = |holds: fn(&singh::Swing) -> bool| swings.iter().filter(|swing| holds(swing)).count();
        let ends = [count(singh::Swing::decays), count(singh::Swing::grows_into_overload)];
        let neither = swings.len() - ends.iter().sum::<usize>();
        vec![format!("{falling} f"), ends[0].to_string(), ends[1].to_string(), neither.to_string()]
    });
    table(&["n", "decays", "grows until an amplifier is overloaded", "continues"], rows)
}

/// The table of critical velocities of Singh's circuit and of the theory.
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

/// The table of critical velocities with the lag in both positions.
fn lag_table() -> String {
    let rows = lag_last::SETTINGS.into_iter().map(|(vcl, tc)| {
        let [(rising, falling), (rising_last, falling_last)] = lag_last::critical(vcl, tc);
        let increase = format!("{:.1} %", 100.0 * (rising_last / rising - 1.0));
        let velocities = [rising, rising_last].map(|velocity| millimetres(velocity, 2));
        let begins = [falling, falling_last].map(|velocity| millimetres(velocity, 2));
        let setting = [millimetres(vcl, 2), format!("{:.1}", tc * 1e3)];
        [&setting[..], &velocities, &[increase], &begins].concat()
    });
    let head = [
        "VcL, mm/s",
        "Tc, ms",
        "rising, oscillation ends, mm/s",
        "lag last",
        "difference",
        "falling, oscillation begins, mm/s",
        "lag last",
    ];
    table(&head, rows)
}

#[test]
#[ignore = "takes ten seconds"]
fn page_agrees_with_the_measurement() {
    let parts = [
        ("singh", singh_table()),
        ("critical", critical_table()),
        ("set", set_table()),
        ("counts", counts_table()),
        ("slow", slow_table()),
        ("relays", relays_table()),
        ("lag-last", lag_table()),
    ];
    for (marker, fresh) in parts {
        assert_part_up_to_date(PAGE, marker, &fresh, "patchcord-thesis");
    }
    assert_page_contains(
        PAGE,
        &[
            format!("at {} mm/s, while the command rises", millimetres(critical_velocity_by_ramp(), 2)),
            format!("die away above {} mm/s, by Routh", millimetres(boundary(), 2)),
            lag_sentence(),
            damping_sentence(),
        ],
    );
}

/// The sentence on damping ratios: the loss by two slow multipliers, the contribution of viscous friction, and its
/// remainder with falling friction.
fn damping_sentence() -> String {
    let table = DrivenTable::simulated(0.0065);
    let (frequency, viscous) = (table.natural_frequency().unwrap(), table.damping_ratio().unwrap());
    let [(_, solid), (_, vcl)] = FRICTION;
    let slope = 2.0 * solid * (vcl - 9e-3) / (vcl * vcl);
    // This share of a quantity with the lag Tc is in phase with velocity.
    let in_phase = 1.0 / (1.0 + (frequency * table.memory).powi(2));
    let remaining = viscous * (1.0 - slope * in_phase / table.damping);
    // Each lag reduces the damping ratio by half of its angle at the natural frequency.
    let loss = 2.0 * 0.5 * frequency * SLOW[1];
    let contribution = format!(
        "Viscous friction gives {viscous:.3}, and at 9 mm/s falling friction leaves {remaining:.3} of that"
    );
    format!("a damping ratio of {loss:.3}. {contribution}")
}

/// The command above which small motions of Nakashima's slideway decay, in m/s.
fn boundary() -> f64 {
    let [(_, solid), (_, vcl)] = FRICTION;
    let friction = FallingFriction { static_friction: solid, limit: vcl };
    DrivenTable::simulated(0.0065).critical_velocity(&friction).unwrap()
}

/// The sentence on the later end of oscillation at VcL = 2.54 mm/s with the lag last.
fn lag_sentence() -> String {
    let steep = lag_last::SETTINGS.into_iter().filter(|(vcl, _)| *vcl == 2.54e-3);
    let increases = steep.map(|(vcl, tc)| {
        let [(rising, _), (last, _)] = lag_last::critical(vcl, tc);
        100.0 * (last / rising - 1.0)
    });
    let increases: Vec<f64> = increases.collect();
    format!(
        "for {:.0} to {:.0} % longer",
        velocity_readings::min(&increases),
        velocity_readings::max(&increases)
    )
}
