//! Rendered pictures contain what they should, and invalid requests are rejected.

use std::f64::consts::TAU;

use super::*;
use crate::plot::{Channel, Marker};

fn channel(name: &str, points: Vec<(f64, f64)>) -> Channel {
    Channel::line(name, points)
}

fn picture(channels: Vec<Channel>) -> Picture {
    let values = || channels.iter().flat_map(|channel| &channel.points);
    let horizontal = Axis::fit("t", "s", values().map(|at| at.0), Axis::HORIZONTAL_DIVISIONS);
    let vertical = Axis::fit("v_o", "mm/s", values().map(|at| at.1), Axis::VERTICAL_DIVISIONS);
    let note = Some("100 ms/div".to_owned());
    Picture { channels, note, ..Picture::new("Stick & <slip>", horizontal, vertical) }
}

fn wave() -> Picture {
    let points = (0..500).map(|n| (f64::from(n) * 0.02, (f64::from(n) * 0.05).sin() * 3.0));
    picture(vec![channel("v_o", points.collect())])
}

fn svg(pictures: &[Picture]) -> String {
    String::from_utf8(render(pictures, Format::Svg, Size::default()).unwrap()).unwrap()
}

/// Returns the width and height in the header of a PNG file.
fn png_size(file: &[u8]) -> (u32, u32) {
    let number = |at: usize| u32::from_be_bytes(file[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

#[test]
fn svg_contains_the_texts() {
    let text = svg(&[wave()]);
    for part in ["Stick &amp; &lt;slip&gt;", "v_o, mm/s", "t, s", "100 ms/div", "−4"] {
        assert!(text.contains(part), "{part}");
    }
    assert!(text.contains(r#"width="900" height="560""#));
}

#[test]
fn legend_names_the_axis_of_each_channel() {
    let mut two = wave();
    let mut second = channel("x_o", vec![(0.0, 1.0), (10.0, 2.0)]);
    second.right = true;
    two.channels.push(second);
    two.vertical_right = Some(Axis::fit("x_o", "mm", [0.0, 2.0], Axis::VERTICAL_DIVISIONS));
    let text = svg(&[two]);
    for part in ["v_o (left)", "x_o (right)", "x_o, mm"] {
        assert!(text.contains(part), "{part}");
    }
}

/// Returns the number of channels in the legend of a picture of this many channels, and the number that its last entry
/// reports as missing; 0 if there is no such entry. `name` gives the name of a channel.
fn legend_counts(channels: usize, name: impl Fn(usize) -> String) -> (usize, usize) {
    let names: Vec<String> = (0..channels).map(name).collect();
    let text =
        svg(&[picture(names.iter().map(|name| channel(name, vec![(0.0, 0.0), (1.0, 1.0)])).collect())]);
    // An ellipsis ends a name that is too long.
    let begins = |name: &&String| text.contains(&format!(">\n{}", &name[..name.len().min(24)]));
    let note = text.split(">\nand ").nth(1).and_then(|rest| rest.split_once(" more\n<"));
    (names.iter().filter(begins).count(), note.map_or(0, |(number, _)| number.parse().unwrap()))
}

#[test]
fn a_legend_reports_the_channels_that_it_has_no_row_for() {
    let short = |index: usize| format!("velocity of mass {index:02}");
    let (shown, missing) = legend_counts(40, short);
    assert!((12..40).contains(&shown), "{shown}");
    assert_eq!(shown + missing, 40);
    assert_eq!(legend_counts(shown, short), (shown, 0));
    // A name as wide as the picture leaves no space for the number in its row.
    let long = |index: usize| format!("{index:02} velocity of a mass {}", "between springs ".repeat(20));
    assert_eq!(legend_counts(40, long), (3, 37));
    assert_eq!(legend_counts(4, long), (4, 0));
}

#[test]
fn png_has_signature_and_size() {
    let size = Size { width: 320, height: 240 };
    let file = render(&[wave(), wave()], Format::Png, size).unwrap();
    assert!(file.starts_with(b"\x89PNG\r\n\x1a\n"));
    assert_eq!(png_size(&file), (320, 480));
}

#[test]
fn a_scale_changes_the_pixels_of_a_png_only() {
    let size = Size { width: 320, height: 240 };
    let render = |format, scale| render_scaled(&[wave()], format, size, scale);
    assert_eq!(png_size(&render(Format::Png, 1.5).unwrap()), (480, 360));
    assert_eq!(render(Format::Svg, 1.5).unwrap(), render(Format::Svg, 1.0).unwrap());
    for scale in [0.0, f64::NAN, 11.0] {
        assert!(matches!(render(Format::Svg, scale).unwrap_err(), PlotError::Scale(_)), "{scale}");
    }
    let large = check_sheet(10, Format::Png, Size::default(), 10.0).unwrap_err();
    assert!(large.to_string().contains("100 million pixels"), "{large}");
}

#[test]
fn a_warning_is_written_and_wrong_points_are_pale() {
    let mut marked = wave();
    marked.warning = Some("A2 over 100 V".to_owned());
    marked.channels[0].wrong.push(250..500);
    let text = svg(&[marked]);
    assert!(text.contains(">\nA2 over 100 V\n<"), "{text}");
    // The pale part is drawn first, the correct part in front of it.
    let lines: Vec<&str> = text.split("<polyline").collect();
    let [pale, full] = [lines[lines.len() - 2], lines[lines.len() - 1]];
    assert!(!pale.contains("#0B3D91") && full.contains("#0B3D91"), "{pale} {full}");
}

#[test]
fn only_traces_drawn_over_themselves_many_times_are_translucent() {
    let circles = |times: u32| {
        let angle = |n: u32| f64::from(n) * 0.1;
        let points = (0..63 * times).map(|n| (5.0 + 4.0 * angle(n).cos(), 4.0 * angle(n).sin()));
        let dense = picture(vec![channel("circle", points.collect())]);
        (svg(std::slice::from_ref(&dense)), dense)
    };
    let is_translucent = |text: &str| text.contains("opacity=\"0");
    assert!(!is_translucent(&svg(&[wave()])) && !is_translucent(&circles(2).0));
    let (text, dense) = circles(12);
    assert!(is_translucent(&text));
    assert!(text.matches("opacity=\"0").count() >= 8);
    assert!(!render(&[dense], Format::Png, Size::default()).unwrap().is_empty());
}

/// Strokes of a sine that touch each other. `times` are those of its points.
fn block(times: &[f64]) -> Picture {
    let points = (0..12_000).map(|n| (f64::from(n) / 12_000.0, (f64::from(n) * TAU / 20.0).sin()));
    picture(vec![Channel { times: times.into(), ..channel("v_o", points.collect()) }])
}

#[test]
fn a_trace_that_fills_an_area_has_shades_of_its_colour() {
    let text = svg(&[block(&[])]);
    assert!(!text.contains("opacity=\"0"));
    let is_line = |line: &&str| line.contains("stroke-width=\"16\"");
    let colour =
        |line: &str| line.split("stroke=\"").nth(1).map_or(String::new(), |rest| rest[..7].to_owned());
    let mut colours: Vec<String> = text.split("<polyline").filter(is_line).map(colour).collect();
    colours.dedup();
    assert!((4..=6).contains(&colours.len()), "{colours:?}");
    // Later ones are darker, and the last one is the colour of the trace.
    let red = |colour: &String| u8::from_str_radix(&colour[1..3], 16).unwrap();
    assert!(colours.is_sorted_by(|one, next| red(one) > red(next)), "{colours:?}");
    assert_eq!(colours.last().map(String::as_str), Some("#0B3D91"));
    // Other times give other shades.
    let times: Vec<f64> = (0..12_000).map(|n| f64::from(n).powi(2)).collect();
    assert!(text != svg(&[block(&times)]));
}

#[test]
fn same_pictures_give_same_bytes() {
    for format in [Format::Svg, Format::Png] {
        let size = Size { width: 300, height: 240 };
        let one = render(&[wave()], format, size).unwrap();
        assert_eq!(one, render(&[wave()], format, size).unwrap());
    }
}

#[test]
fn markers_and_labels_are_written_if_they_fit() {
    let mark = |at: f64, label: &str| Marker { at, label: label.to_owned() };
    let mut marked = wave();
    marked.markers =
        vec![mark(4.0, "k = 20 N/m"), mark(2.0, "hold"), mark(2.1, "below"), mark(2.2, "no space")];
    marked.markers.push(mark(99.0, "outside"));
    marked.channels[0].labels = vec![(499, "m = 2 kg".to_owned()), (7000, "no such point".to_owned())];
    let text = svg(&[marked.clone()]);
    for part in ["hold", "below", "k = 20 N/m", "m = 2 kg"] {
        assert!(text.contains(&format!(">\n{part}\n<")), "{part}");
    }
    for part in ["no space", "outside", "no such point"] {
        assert!(!text.contains(part), "{part}");
    }
    assert!(!render(&[marked], Format::Png, Size::default()).unwrap().is_empty());
}

/// Returns the corners of each polygon of an SVG file.
fn areas(text: &str) -> Vec<Vec<(f64, f64)>> {
    let corner = |pair: &str| {
        let (x, y) = pair.split_once(',').unwrap();
        (x.parse().unwrap(), y.parse().unwrap())
    };
    let corners = |part: &str| part.split('"').next().unwrap().split_whitespace().map(corner).collect();
    text.split("<polygon").skip(1).map(|part| corners(part.split("points=\"").nth(1).unwrap())).collect()
}

#[test]
fn errors_are_bands_behind_lines_and_bars_through_dots() {
    let errors = vec![0.5, 0.5, 0.5, 99.0];
    let points = vec![(0.0, 0.0), (4.0, 1.0), (f64::NAN, 0.0), (8.0, 2.0)];
    let line = Channel { errors: errors.clone(), ..channel("line", points.clone()) };
    let dots = Channel { errors, ..Channel::dots("dots", points) };
    let plain = picture(vec![channel("line", line.points.clone())]);
    let lines = |picture: Picture| svg(&[picture]).matches("<polyline").count();
    let banded = svg(&[Picture { channels: vec![line], ..plain.clone() }]);
    // The band is clamped to the screen.
    let heights = areas(&banded).into_iter().map(|corners| {
        let ends = corners.iter().map(|at| at.1).fold([f64::MAX, f64::MIN], |[a, b], y| [a.min(y), b.max(y)]);
        ends[1] - ends[0]
    });
    let heights: Vec<f64> = heights.collect();
    assert_eq!(heights.len(), 2);
    assert!(heights[0] > 0.0 && heights[1] > heights[0] && heights[1] < 5600.0, "{heights:?}");
    let barred = Picture { channels: vec![dots.clone()], ..plain.clone() };
    let bare = Picture { channels: vec![Channel { errors: vec![], ..dots }], ..plain.clone() };
    assert_eq!(lines(barred), lines(bare) + 3);
}

#[test]
fn faint_traces_are_behind_and_spans_are_at_the_back() {
    let faint = Channel { faint: true, ..channel("scatter", vec![(0.0, 0.0), (9.0, 3.0)]) };
    let marked = Picture { spans: vec![[2.0, 4.0], [9.0, 99.0]], ..wave() };
    let rectangles = |picture: Picture| svg(&[picture]).matches("<rect").count();
    assert_eq!(rectangles(marked), rectangles(wave()) + 2);
    let mut both = wave();
    both.channels.push(faint);
    let text = svg(&[both]);
    let lines: Vec<&str> = text.split("<polyline").collect();
    let [before, last] = [lines[lines.len() - 2], lines[lines.len() - 1]];
    assert!(before.contains("#B0B7C0") && last.contains("#0B3D91"), "{before} {last}");
}

#[test]
fn degenerate_pictures_are_drawn() {
    let nan = f64::NAN;
    let mut odd = picture(vec![
        channel("", vec![]),
        channel("only gaps", vec![(nan, 1.0), (0.0, f64::INFINITY)]),
        channel("far", vec![(f64::MIN, f64::MAX), (1.0, f64::MIN)]),
        channel("dot", vec![(0.0, 0.0)]),
    ]);
    odd.title = "very long \u{1}\n".repeat(200);
    odd.vertical.label = "long".repeat(200);
    odd.channels[0].name = "name ".repeat(200);
    odd.note = Some("note ".repeat(200));
    let marks = [f64::NAN, f64::INFINITY, f64::MIN, 0.0, 0.5, 0.5];
    odd.markers = marks.map(|at| Marker { at, label: "mark ".repeat(200) }).to_vec();
    odd.channels[1].labels = vec![(0, "label ".repeat(200)), (1, String::new())];
    odd.channels[2].labels = vec![(1, "far".to_owned())];
    odd.channels[1].errors = vec![f64::NAN, 1.0];
    odd.channels[2].errors = vec![f64::MAX, f64::INFINITY];
    odd.channels[3].errors = vec![1.0; 7];
    odd.spans = vec![[f64::NAN, 1.0], [f64::MIN, f64::MAX], [1.0, 0.0]];
    odd.channels.extend((0..40).map(|n| channel(&format!("channel number {n}"), vec![])));
    let size = Size { width: Size::MIN_SIDE, height: Size::MIN_SIDE };
    for format in [Format::Svg, Format::Png] {
        assert!(!render(&[odd.clone(), picture(vec![])], format, size).unwrap().is_empty());
    }
    assert!(!svg(&[odd]).contains('\u{1}'));
}

#[test]
fn invalid_requests_are_rejected() {
    let rejection = |pictures: &[Picture], width| {
        let size = Size { width, height: 560 };
        render(pictures, Format::Svg, size).unwrap_err()
    };
    assert!(matches!(rejection(&[], 900), PlotError::NoPictures));
    let error = rejection(&[wave()], 10);
    assert!(matches!(error, PlotError::Size(_)));
    assert_eq!(error.to_string(), "each side of a picture must have 240 to 4000 pixels, got 10 x 560");
    assert!(matches!(rejection(&vec![wave(); 200], 900), PlotError::TooTall { .. }));
    for (low, high, divisions) in [(0.0, f64::NAN, 8), (1.0, 1.0, 8), (0.0, 1.0, 0)] {
        let mut bad = wave();
        bad.vertical = Axis { low, high, divisions, ..bad.vertical };
        assert!(matches!(rejection(&[bad], 900), PlotError::Range { .. }));
    }
}
