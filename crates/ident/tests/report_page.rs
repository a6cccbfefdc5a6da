//! The HTML page of a search shows the localisation, with every point of its curves.

use std::sync::LazyLock;

use crate::localisation::oscillator;
use patchcord_ident::Experiment;
use patchcord_ident::effects::Library;
use patchcord_ident::fit::problem::Problem;
use patchcord_ident::report::Report;
use patchcord_ident::search::{Outcome, SearchSettings};

/// The text of the page's section with this heading. `None` if the page has no such section.
fn section<'a>(page: &'a str, heading: &str) -> Option<&'a str> {
    let after = page.split(&format!("<h2>{heading}</h2>")).nth(1)?;
    after.split("</section>").next()
}

/// The search for a force that is a bell curve of position, with an empty library.
pub(crate) static BELL_FORCE_SEARCH: LazyLock<(Experiment, Problem, Outcome)> = LazyLock::new(|| {
    let experiment = oscillator().measured();
    let problem = Problem::of(&experiment).unwrap();
    let library = Library::default();
    let settings = SearchSettings::new(&library).with_threads(1);
    let outcome = patchcord_ident::search::search(&experiment, &problem, &settings, |_| ()).unwrap().unwrap();
    (experiment, problem, outcome)
});

#[test]
#[ignore = "takes several seconds: a whole search"]
fn the_page_shows_the_localisation_with_every_point() {
    let (experiment, problem, outcome) = &*BELL_FORCE_SEARCH;
    let page = Report::new(experiment, problem, outcome).page(&Library::default()).unwrap();
    let section = section(&page, "Where and when a force is missing").unwrap();
    let best = &outcome.localisations[0];
    assert!(
        section.contains("The gap is best explained at IV, between t = ")
            && section.contains("by a force that depends on x.")
    );
    for localisation in &outcome.localisations {
        assert!(
            section.contains(&format!("<td>{}</td><td>{}</td>", localisation.junction, localisation.unit))
        );
    }
    let count_shapes = |shape: &str, colour: &str| {
        let tags = section.split(shape).skip(1).filter_map(|rest| rest.split('>').next());
        tags.filter(|tag| tag.contains(colour)).count()
    };
    // One picture shows the force over time, with a band of its errors and grey rectangles over the windows in which it
    // acts. Each curve has one more picture.
    assert_eq!(section.matches("<svg class=\"picture\"").count(), 1 + best.curves.len());
    assert_eq!((count_shapes("<polygon", ""), count_shapes("<rect", "#ECEEF1")), (1, best.windows().count()));
    // Each point is a circle, and each legend has one more.
    let scatter: usize = best.curves.iter().map(|curve| curve.scatter.len() + 1).sum();
    assert_eq!(count_shapes("<circle", "#B0B7C0"), scatter);
    let falling = best.curves.iter().filter_map(|curve| curve.by_direction.as_ref());
    assert_eq!(
        count_shapes("<circle", "#D55E00"),
        falling.map(|[_, falling]| falling.len() + 1).sum::<usize>()
    );
    let curve = &best.curves[best.best_curve.unwrap()];
    let numbers = section.split("Points of the curve").nth(1).unwrap();
    assert_eq!(numbers.matches("<tr>").count(), 1 + curve.points.len());
    assert!(section.contains("href=\"recovered.json\"") && !page.contains("NaN"));
}
