//! Chapters 2 and 4: velocity profiles. A profile plots the output velocity against a command that rises slowly;
//! chapter 4 explains its parts.

use super::{DrawnFigure, Figure, Recipe, with_title};
use crate::replay::recipe::BoxError;
use crate::replay::run_record::format_critical_velocity;
use patchcord_analysis::format::format_quantity;
use patchcord_analysis::instruments::{
    Criterion, ProfileCriterion, RampDirection, critical_velocity, velocity_profile,
};
use patchcord_draw::{self as draw, profile_picture};

/// The figures, in their order.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "fig-2-03",
        place: "2.5",
        title: "a typical system velocity profile",
        claims: &["2-034", "4-104"],
        draw: typical,
    },
    Figure {
        id: "fig-4-07",
        place: "4.5",
        title: "velocity profiles of one table on three kinds of friction",
        claims: &["4-021", "4-022"],
        draw: three_kinds,
    },
    Figure {
        id: "fig-4-08",
        place: "4.5",
        title: "a velocity profile explained: points 1 to 5, sections A to D",
        claims: &["4-023", "4-025", "4-026", "4-027"],
        draw: explained,
    },
];

/// Fig 2.3: a profile of the final circuit with VcL = 7.62 mm/s.
fn typical(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let recipe = Recipe::new("fig-8-16").set("VcL", 7.62e-3);
    let run = figure.run(&recipe.add_picture(&figure.heading(), "v_i", &["v_o"]), "")?;
    let rising = format_critical_velocity(run.record.critical_velocity()?.rising);
    DrawnFigure::from_run(
        &run,
        format!("the profile shows the whole course of oscillation, which ends at {rising}"),
    )
}

/// Fig 4.7: steady friction, and the profiles of the three tables of `patches/thesis/fig-4-07.json`.
fn three_kinds(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run = figure.run(&Recipe::new("fig-4-07"), "")?;
    let titles = ["steady friction, as Fig 4.6", "(a) linear", "(b) falling", "(c) dropping to a constant"];
    let pictures =
        run.pictures()?.into_iter().zip(titles).map(|(picture, title)| with_title(picture, title)).collect();
    let (time, command) = (&run.record.trace.time, run.record.values("v_i")?);
    let rising = |signal| -> Result<String, BoxError> {
        let read = critical_velocity(time, &command, &run.record.values(signal)?, Criterion::USUAL).rising;
        Ok(format_critical_velocity(read))
    };
    let reading = format!(
        "oscillation ends with linear friction: {}; with falling friction: {}; with friction that drops to a \
         constant: {}",
        rising("linear.v_o")?,
        rising("stribeck.v_o")?,
        rising("coulomb.v_o")?
    );
    DrawnFigure::from_runs(&[&run], pictures, run.settings(), reading)
}

/// Fig 4.8: a profile of the final circuit with VcL = 5.08 mm/s, with the points and sections that `patchcord
/// profile` reads.
fn explained(figure: &Figure) -> Result<DrawnFigure, BoxError> {
    let run =
        figure.run(&Recipe::new("fig-8-16").set("VcL", 5.08e-3).add_picture("", "v_i", &["v_o"]), "")?;
    let [command, velocity] = [run.record.values("v_i")?, run.record.values("v_o")?];
    let criterion = ProfileCriterion::usual(Criterion::USUAL);
    let profile =
        velocity_profile(&run.record.trace.time, &command, &velocity, criterion, RampDirection::Rising)?;
    let signal = |name, values| draw::ProfileSignal { name, unit: "m/s", values };
    let (along, up) = (signal("v_i", &command[..]), signal("v_o", &velocity[..]));
    let picture = profile_picture(figure.heading(), along, up, &profile, Some(&run.settings()));
    let points = profile.points.iter().zip(profile.direction.point_names()).enumerate().filter_map(
        |(index, (point, name))| {
            Some(format!("{} {name} at {}", index + 1, format_quantity(point.ok()?.command, "m/s")))
        },
    );
    let reading = points.collect::<Vec<_>>().join(", ");
    let drawn = DrawnFigure::from_runs(&[&run], vec![picture], run.settings(), reading)?;
    Ok(DrawnFigure { commands: vec![format!("patchcord profile {}", run.patch().file())], ..drawn })
}
