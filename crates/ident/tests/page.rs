//! The page of a search: what stands on it is what was found.

use std::sync::LazyLock;

use crate::r#where::oscillator;
use patchcord_ident::Experiment;
use patchcord_ident::effects::Library;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::Report;
use patchcord_ident::search::{Means, Outcome};

/// The section of a page under a heading.
fn section<'a>(page: &'a str, heading: &str) -> Option<&'a str> {
    let from = page.split(&format!("<h2>{heading}</h2>")).nth(1)?;
    from.split("</section>").next()
}

/// What is found of a hill of force that no library knows.
pub static HILL: LazyLock<(Experiment, Problem, Outcome)> = LazyLock::new(|| {
    let experiment = oscillator().measured();
    let problem = Problem::of(&experiment).unwrap();
    let with = Means { library: &Library::default(), threads: 1, seed: 1 };
    let outcome =
        patchcord_ident::search::search(&problem, &experiment.patch, &experiment.fit, &with, |_| ())
            .unwrap()
            .unwrap();
    (experiment, problem, outcome)
});

#[test]
#[ignore = "takes several seconds: a whole search"]
fn where_and_when_stands_on_the_page_with_every_point_of_it() {
    let (experiment, problem, outcome) = &*HILL;
    let page = Report::new(experiment, problem, outcome).page(&Library::default()).unwrap();
    let section = section(&page, "Where and when something is missing").unwrap();
    let best = &outcome.whereabouts[0];
    assert!(
        section.contains("The gap is best explained at IV, between t = ")
            && section.contains("as a force of x.")
    );
    for own in &outcome.whereabouts {
        assert!(section.contains(&format!("<td>{}<td>{}", own.junction, own.unit)), "{}", own.junction);
    }
    let shapes = |shape: &str, colour: &str| {
        let all = section.split(shape).skip(1).filter_map(|rest| rest.split('>').next());
        all.filter(|rest| rest.contains(colour)).count()
    };
    // A picture of the force over time, with a band for its errors and what is darker when it acts, and one of each curve.
    assert_eq!(section.matches("<svg class=\"picture\"").count(), 1 + best.curves.len());
    assert_eq!((shapes("<polygon", ""), shapes("<rect", "#ECEEF1")), (1, best.windows().count()));
    // Every point is there, and one beside each name in the legends.
    let scatter: usize = best.curves.iter().map(|curve| curve.scatter.len() + 1).sum();
    assert_eq!(shapes("<circle", "#B0B7C0"), scatter);
    let falling = best.curves.iter().filter_map(|curve| curve.by_direction.as_ref());
    assert_eq!(shapes("<circle", "#D55E00"), falling.map(|[_, falling]| falling.len() + 1).sum::<usize>());
    let curve = &best.curves[best.best.unwrap()];
    let numbers = section.split("The curve in numbers").nth(1).unwrap();
    assert_eq!(numbers.matches("<tr>").count(), 1 + curve.points.len());
    assert!(section.contains("href=\"recovered.json\"") && !page.contains("NaN"));
}
