//! Chapters 2 and 4: velocity profiles, as chapter 4 explains them.

use super::{Drawn, Figure, Recipe, titled, told};
use crate::replay::recipe::{Problem, velocity_told};
use patchcord_analysis::instruments::{
    Criterion, ProfileCriterion, Way, critical_velocity, velocity_profile,
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

fn typical(figure: &Figure) -> Result<Drawn, Problem> {
    let recipe = Recipe::of("fig-8-16").set("VcL", 7.62e-3);
    let run = figure.run(&recipe.picture(&figure.heading(), "v_i", &["v_o"]), "")?;
    let rising = velocity_told(run.critical()?.rising);
    Drawn::of_run(&run, format!("the whole history of oscillation in one picture: it ends at {rising}"))
}

fn three_kinds(figure: &Figure) -> Result<Drawn, Problem> {
    let run = figure.run(&Recipe::of("fig-4-07"), "")?;
    let titles = ["steady friction, as Fig 4.6", "(a) linear", "(b) falling", "(c) dropping to a constant"];
    let pictures =
        run.pictures()?.into_iter().zip(titles).map(|(picture, title)| titled(picture, title)).collect();
    let (time, command) = (&run.trace.time, run.values("v_i")?);
    let rising = |signal| -> Result<String, Problem> {
        let read = critical_velocity(time, &command, &run.values(signal)?, Criterion::USUAL).rising;
        Ok(velocity_told(read))
    };
    let reading = format!(
        "oscillation ends, on linear friction: {}; on falling friction: {}; on friction that drops to a constant: {}",
        rising("linear.v_o")?,
        rising("stribeck.v_o")?,
        rising("coulomb.v_o")?
    );
    Drawn::of_runs(&[&run], pictures, run.settings(), reading)
}

fn explained(figure: &Figure) -> Result<Drawn, Problem> {
    let run = figure.run(&Recipe::of("fig-8-16").set("VcL", 5.08e-3).picture("", "v_i", &["v_o"]), "")?;
    let [command, velocity] = [run.values("v_i")?, run.values("v_o")?];
    let criterion = ProfileCriterion::usual(Criterion::USUAL);
    let profile = velocity_profile(&run.trace.time, &command, &velocity, criterion, Way::Rising)?;
    let signal = |name, values| draw::Drawn { name, unit: "m/s", values };
    let (along, up) = (signal("v_i", &command[..]), signal("v_o", &velocity[..]));
    let picture = profile_picture(figure.heading(), along, up, &profile, Some(run.settings()));
    let points =
        profile.points.iter().zip(profile.way.points()).enumerate().filter_map(|(index, (point, name))| {
            Some(format!("{} {name} at {}", index + 1, told(point.ok()?.command, "m/s")))
        });
    let reading = points.collect::<Vec<_>>().join(", ");
    let drawn = Drawn::of_runs(&[&run], vec![picture], run.settings(), reading)?;
    Ok(Drawn { commands: vec![format!("patchcord profile {}", run.patch().file())], ..drawn })
}
