//! The labels next to lines and dots.
//!
//! For each label the positions next to points near the end of its line are tried. A position must be
//! on the screen and free of other texts. The first one that crosses no line and is close to its own
//! line only is used; if there is none, the one with the smallest penalty. If a line crosses that one too, the
//! label is placed away from its line, with a leader.

use super::callout;
use super::clip::{Area, Line, clip};
use super::surface::{Align, Surface, TextStyle};
use super::trace::{DOT_RADIUS, Projection};
use super::{Channel, Picture, PlotError, font, graticule, palette};

/// The em size of the labels.
const TEXT_SIZE: f64 = 11.5;

/// The distance from a point to its label.
const OFFSET: f64 = 5.0;
/// The height of a label.
const HEIGHT: f64 = 12.0;

/// A line closer to a label than this could be mistaken for the line of the label.
const AMBIGUITY_DISTANCE: f64 = 8.0;

/// The penalty of a line that crosses the label, relative to a line that is close to it.
const CROSSING_PENALTY: usize = 10;

/// The number of steps backward from the end of a line at which a label is tried.
const STEPS: usize = 40;

/// The share of the points of a line, from its end backward, at which a label may be.
const MAX_SHARE: f64 = 0.7;

/// The thickness of the leader of a label.
const LEADER_WIDTH: f64 = 0.8;

/// Writes the labels of the channels. A label is omitted if no position is free.
///
/// `lines` are the visible lines of all channels, and `taken` the areas of other texts.
pub(super) fn draw(
    picture: &Picture,
    mut lines: Vec<Line>,
    mut taken: Vec<Area>,
    screen: Area,
    surface: &mut dyn Surface,
) -> Result<(), PlotError> {
    let zero_lines = graticule::zero_lines(picture, screen);
    for channel in &picture.channels {
        let projection = Projection { picture, channel, screen };
        for (end, label) in &channel.labels {
            let label = font::truncated(label, TEXT_SIZE, screen.width() / 2.0);
            let width = font::width(&label, TEXT_SIZE);
            let points = candidate_points(channel, *end).filter_map(|point| channel.points.get(point));
            let points: Vec<_> = points.map(|point| projection.project(*point)).collect();
            let size = (clearance(channel), width);
            let Some(place) = place(&points, size, screen, &lines, &zero_lines, &taken) else { continue };
            if let Some(leader) = place.leader {
                surface.line(&leader, LEADER_WIDTH, palette::NOTE)?;
                lines.push(leader.to_vec());
            }
            let style = TextStyle { size: TEXT_SIZE, colour: palette::TEXT, align: Align::Start };
            surface.text(&label, (place.area.left, place.area.bottom - 0.2 * HEIGHT), style)?;
            taken.push(place.area);
        }
    }
    Ok(())
}

/// The place of a label.
struct Place {
    /// The area of the text.
    area: Area,
    /// The leader from the line to the text; `None` if the text is next to its line.
    leader: Option<[(f64, f64); 2]>,
}

/// Returns the place of a label for a line through `points`; `None` if no position is free.
///
/// The label has a clearance from its point and a width. If a line crosses every position next to the line, the label
/// gets a leader if there is space for it.
fn place(
    points: &[(f64, f64)],
    (clearance, width): (f64, f64),
    screen: Area,
    lines: &[Line],
    zero_lines: &[Line],
    taken: &[Area],
) -> Option<Place> {
    let all = points.iter().flat_map(|point| label_areas(*point, clearance, width));
    let is_free = |area: &Area| screen.encloses(area) && !taken.iter().any(|other| other.overlaps(area));
    let next_to_line = least_ambiguous(all.filter(is_free), lines, zero_lines);
    if let Some((_, area)) = next_to_line.filter(|(penalty, _)| *penalty < CROSSING_PENALTY) {
        return Some(Place { area, leader: None });
    }
    match callout::best(points, (width, HEIGHT), screen, lines, taken) {
        Some(callout) => Some(Place { area: callout.area, leader: Some(callout.leader) }),
        None => next_to_line.map(|(_, area)| Place { area, leader: None }),
    }
}

/// Returns the distance of a label from its point. The label of a dot is clear of the dot.
fn clearance(channel: &Channel) -> f64 {
    if channel.dots { OFFSET + DOT_RADIUS } else { OFFSET }
}

/// Returns the indices of the points at which the label of the line that ends at `end` may be placed.
///
/// They are in order from `end` backward and do not leave the line. For a dot it is `end` only.
fn candidate_points(channel: &Channel, end: usize) -> impl Iterator<Item = usize> {
    let begin = if channel.dots { end } else { line_start(channel, end) };
    let back = (end - begin) as f64 * MAX_SHARE / STEPS as f64;
    let mut points: Vec<usize> = (0..=STEPS).map(|step| end - (step as f64 * back) as usize).collect();
    points.dedup();
    points.into_iter()
}

/// Returns the index of the first point of the line that contains the point `end`.
fn line_start(channel: &Channel, end: usize) -> usize {
    channel.breaks.iter().copied().filter(|begin| *begin <= end).max().unwrap_or(0)
}

/// Returns the possible areas of a label next to a point in order of preference: right, above, below.
fn label_areas((x, y): (f64, f64), clearance: f64, width: f64) -> [Area; 5] {
    let area = |left: f64, middle: f64| Area {
        left,
        top: middle - HEIGHT / 2.0,
        right: left + width,
        bottom: middle + HEIGHT / 2.0,
    };
    let (right, left, offset) = (x + clearance, x - clearance - width, HEIGHT / 2.0 + clearance);
    [
        area(right, y),
        area(right, y - offset),
        area(right, y + offset),
        area(left, y - offset),
        area(left, y + offset),
    ]
}

/// Returns the first area that no line crosses and that is close to one line only, with its penalty. A line at zero
/// cannot be mistaken for the line of the label, so it may be close.
///
/// If there is none, the area with the smallest penalty is returned; `None` if there are no areas.
fn least_ambiguous(
    areas: impl Iterator<Item = Area>,
    lines: &[Line],
    zero_lines: &[Line],
) -> Option<(usize, Area)> {
    let mut best: Option<(usize, Area)> = None;
    for area in areas {
        let crossings = lines_in(area, lines) + lines_in(area, zero_lines);
        let close = lines_in(area.grown(AMBIGUITY_DISTANCE), lines);
        let penalty = CROSSING_PENALTY * crossings + close.saturating_sub(1);
        if penalty == 0 {
            return Some((penalty, area));
        }
        if best.is_none_or(|(lowest, _)| penalty < lowest) {
            best = Some((penalty, area));
        }
    }
    best
}

/// Returns the number of lines that have a part in an area.
fn lines_in(area: Area, lines: &[Line]) -> usize {
    lines.iter().filter(|line| !clip(line, area).is_empty()).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LABEL: Area = Area { left: 10.0, top: 10.0, right: 20.0, bottom: 20.0 };

    #[test]
    fn a_label_avoids_lines() {
        let next = Area { left: 30.0, right: 40.0, ..LABEL };
        let line = vec![(0.0, 15.0), (21.0, 15.0)];
        let one = std::slice::from_ref(&line);
        assert_eq!(least_ambiguous([LABEL, next].into_iter(), one, &[]), Some((0, next)));
        let other = vec![(35.0, 0.0), (35.0, 40.0)];
        let both = [line, other.clone(), other];
        assert_eq!(
            least_ambiguous([next, LABEL].into_iter(), &both, &[]).map(|(_, area)| area),
            Some(LABEL),
            "one crossing is better than two"
        );
        assert_eq!(least_ambiguous(std::iter::empty(), &both, &[]), None);
        let near = [vec![(5.0, 0.0), (5.0, 40.0)], vec![(25.0, 0.0), (25.0, 40.0)]];
        let clear = Area { left: 50.0, right: 60.0, ..LABEL };
        assert_eq!(
            least_ambiguous([LABEL, clear].into_iter(), &near, &[]),
            Some((0, clear)),
            "a label between two lines is ambiguous"
        );
    }

    #[test]
    fn a_label_avoids_lines_at_zero_and_may_be_close_to_them() {
        let zero = [vec![(0.0, 15.0), (100.0, 15.0)]];
        let above = Area { top: 0.0, bottom: 10.0, ..LABEL };
        assert_eq!(least_ambiguous([LABEL, above].into_iter(), &[], &zero), Some((0, above)));
    }

    #[test]
    fn the_label_of_a_line_stays_on_that_line() {
        let channel = Channel { breaks: vec![0, 100, 200], ..Channel::line("", vec![(0.0, 0.0); 300]) };
        let all: Vec<usize> = candidate_points(&channel, 199).collect();
        assert_eq!((all[0], all.iter().min()), (199, Some(&130)));
        assert_eq!(candidate_points(&channel, 100).collect::<Vec<_>>(), [100]);
        let dots = Channel::dots("", vec![(0.0, 0.0); 300]);
        assert_eq!(candidate_points(&dots, 199).collect::<Vec<_>>(), [199]);
    }

    #[test]
    fn a_label_between_close_lines_gets_a_leader() {
        let screen = Area { left: 0.0, top: 0.0, right: 400.0, bottom: 300.0 };
        let line = |y: f64| -> Line { (0..6).map(|n| (80.0 * f64::from(n), y)).collect() };
        let close: Vec<Line> = (0..6).map(|n| line(150.0 + 3.0 * f64::from(n))).collect();
        let placed = |lines: &[Line]| {
            let middle = &lines[lines.len() / 2];
            place(middle, (5.0, 50.0), screen, lines, &[], &[]).unwrap()
        };
        assert!(placed(&close).leader.is_some());
        assert!(placed(&close[..1]).leader.is_none());
    }
}
