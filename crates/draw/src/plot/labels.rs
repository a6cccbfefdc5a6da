use super::clip::{Area, clipped};
use super::font::Font;
use super::surface::{Align, Lettering, Surface};
use super::trace::{DOT, Line, Projection};
use super::{Channel, Picture, PlotError, palette};

/// Em size of the labels.
const TEXT: f64 = 11.5;

/// Distance of a label from its point, and the height that it takes.
const AWAY: f64 = 5.0;
const HEIGHT: f64 = 12.0;

/// A line nearer than this may be taken for the one that a label belongs to.
const NEAR: f64 = 8.0;

/// How much worse than a line that is near is one that crosses the label.
const CROSSED: usize = 10;

/// How many points of a line are tried for its label, from its end backward.
const TRIED: usize = 40;

/// How far back from the end of a line its label may stand, as a share of its points.
const REACH: f64 = 0.7;

/// Writes the labels of the channels beside their lines, where they cross fewest of them; where there is no room
/// for a label it is left out. `taken` is where other texts stand.
pub(super) fn draw(
    picture: &Picture,
    lines: &[Line],
    mut taken: Vec<Area>,
    screen: Area,
    font: &Font,
    surface: &mut dyn Surface,
) -> Result<(), PlotError> {
    for channel in &picture.channels {
        let onto = Projection { picture, channel, screen };
        for (end, label) in &channel.labels {
            let label = font.shortened(label, TEXT, screen.width() / 2.0);
            let width = font.width(&label, TEXT);
            let points = tried(channel, *end).filter_map(|point| channel.points.get(point));
            let all = points.flat_map(|point| places(onto.place(*point), clearance(channel), width));
            let is_free = |place: &Area| screen.holds(place) && !taken.iter().any(|other| other.meets(place));
            if let Some(place) = clearest(all.filter(is_free), lines) {
                let lettering = Lettering { size: TEXT, colour: palette::TEXT, align: Align::Start };
                surface.text(&label, (place.left, place.bottom - 0.2 * HEIGHT), lettering)?;
                taken.push(place);
            }
        }
    }
    Ok(())
}

/// How far from its point a label stands: clear of a dot.
fn clearance(channel: &Channel) -> f64 {
    if channel.dots { AWAY + DOT } else { AWAY }
}

/// Points of the line that ends at a point, from there backward; a dot stands alone.
fn tried(channel: &Channel, end: usize) -> impl Iterator<Item = usize> {
    let begin = if channel.dots { end } else { begin_of_line(channel, end) };
    let back = (end - begin) as f64 * REACH / TRIED as f64;
    let mut points: Vec<usize> = (0..=TRIED).map(|tried| end - (tried as f64 * back) as usize).collect();
    points.dedup();
    points.into_iter()
}

fn begin_of_line(channel: &Channel, end: usize) -> usize {
    channel.breaks.iter().copied().filter(|begin| *begin <= end).max().unwrap_or(0)
}

/// Where the label of a point may stand, the best place first: to its right, above and below it.
fn places((x, y): (f64, f64), clear: f64, width: f64) -> [Area; 5] {
    let area = |left: f64, middle: f64| Area {
        left,
        top: middle - HEIGHT / 2.0,
        right: left + width,
        bottom: middle + HEIGHT / 2.0,
    };
    let (right, left, away) = (x + clear, x - clear - width, HEIGHT / 2.0 + clear);
    [area(right, y), area(right, y - away), area(right, y + away), area(left, y - away), area(left, y + away)]
}

/// The first place that crosses no line and is near to one only, its own; where there is none, the best of them.
fn clearest(places: impl Iterator<Item = Area>, lines: &[Line]) -> Option<Area> {
    let mut best: Option<(usize, Area)> = None;
    for place in places {
        let met = |area: Area| lines.iter().filter(|line| !clipped(line, area).is_empty()).count();
        let doubt = CROSSED * met(place) + met(place.grown(NEAR)).saturating_sub(1);
        if doubt == 0 {
            return Some(place);
        }
        if best.is_none_or(|(least, _)| doubt < least) {
            best = Some((doubt, place));
        }
    }
    best.map(|(_, place)| place)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACE: Area = Area { left: 10.0, top: 10.0, right: 20.0, bottom: 20.0 };

    #[test]
    fn a_label_stands_where_no_line_is() {
        let beside = Area { left: 30.0, right: 40.0, ..PLACE };
        let line = vec![(0.0, 15.0), (21.0, 15.0)];
        assert_eq!(clearest([PLACE, beside].into_iter(), std::slice::from_ref(&line)), Some(beside));
        let other = vec![(35.0, 0.0), (35.0, 40.0)];
        let both = [line, other.clone(), other];
        assert_eq!(clearest([beside, PLACE].into_iter(), &both), Some(PLACE), "one line is less than two");
        assert_eq!(clearest(std::iter::empty(), &both), None);
        let near = [vec![(5.0, 0.0), (5.0, 40.0)], vec![(25.0, 0.0), (25.0, 40.0)]];
        let clear = Area { left: 50.0, right: 60.0, ..PLACE };
        assert_eq!(
            clearest([PLACE, clear].into_iter(), &near),
            Some(clear),
            "a label between two lines is neither's"
        );
    }

    #[test]
    fn the_label_of_a_line_stays_on_that_line() {
        let channel = Channel { breaks: vec![0, 100, 200], ..Channel::line("", vec![(0.0, 0.0); 300]) };
        let all: Vec<usize> = tried(&channel, 199).collect();
        assert_eq!((all[0], all.iter().min()), (199, Some(&130)));
        assert_eq!(tried(&channel, 100).collect::<Vec<_>>(), [100]);
        let dots = Channel::dots("", vec![(0.0, 0.0); 300]);
        assert_eq!(tried(&dots, 199).collect::<Vec<_>>(), [199]);
    }
}
