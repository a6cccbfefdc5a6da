use super::font::Font;
use super::layout::Frame;
use super::{Axis, Format, Picture, PlotError, raster, svg};

/// The size of one picture in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Pixels across, [`Size::LEAST`] to [`Size::MOST`].
    pub width: u32,
    /// Pixels down, [`Size::LEAST`] to [`Size::MOST`].
    pub height: u32,
}

impl Size {
    /// The shortest side a picture may have.
    pub const LEAST: u32 = 240;
    /// The longest side a picture may have.
    pub const MOST: u32 = 4000;
    /// The greatest height of a sheet of pictures.
    pub const TALLEST: u32 = 60_000;
}

impl Default for Size {
    fn default() -> Size {
        Size { width: 900, height: 560 }
    }
}

/// Draws pictures, each of the given size, one below the other, and gives the
/// bytes of a file. The same pictures always give the same bytes.
///
/// Long traces are thinned to what can be seen; lines end at the edge of the
/// screen; texts too long for the picture are cut and end in an ellipsis.
///
/// # Errors
///
/// [`PlotError::NoPictures`] without a picture, [`PlotError::Size`] and
/// [`PlotError::TooTall`] for sizes beyond the limits of [`Size`],
/// [`PlotError::Range`] for an axis whose ends are equal or not finite or whose
/// divisions are not 1 to [`Axis::MOST_DIVISIONS`], and the others when the
/// file cannot be put together.
pub fn render(pictures: &[Picture], format: Format, size: Size) -> Result<Vec<u8>, PlotError> {
    check_size(size, pictures.len())?;
    pictures.iter().flat_map(Picture::axes).try_for_each(check_axis)?;
    let font = Font::load()?;
    let frame = Frame::around(pictures, size, &font);
    match format {
        Format::Svg => svg::sheet(pictures, size, &frame, &font),
        Format::Png => raster::sheet(pictures, size, &frame, &font),
    }
}

fn check_size(size: Size, pictures: usize) -> Result<(), PlotError> {
    let possible = Size::LEAST..=Size::MOST;
    if pictures == 0 {
        Err(PlotError::NoPictures)
    } else if !possible.contains(&size.width) || !possible.contains(&size.height) {
        Err(PlotError::Size(size))
    } else if pictures > (Size::TALLEST / size.height) as usize {
        Err(PlotError::TooTall { pictures })
    } else {
        Ok(())
    }
}

fn check_axis(axis: &Axis) -> Result<(), PlotError> {
    if axis.is_drawable() {
        return Ok(());
    }
    Err(PlotError::Range {
        label: axis.label.clone(),
        low: axis.low,
        high: axis.high,
        divisions: axis.divisions,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Channel, Mark};

    fn channel(name: &str, points: Vec<(f64, f64)>) -> Channel {
        Channel::line(name, points)
    }

    fn picture(channels: Vec<Channel>) -> Picture {
        let values = || channels.iter().flat_map(|channel| &channel.points);
        let horizontal = Axis::fit("t", "s", values().map(|at| at.0), Axis::ACROSS);
        let vertical = Axis::fit("v_o", "mm/s", values().map(|at| at.1), Axis::UP);
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

    /// Width and height as the file itself tells them.
    fn png_size(file: &[u8]) -> (u32, u32) {
        let number = |at: usize| u32::from_be_bytes(file[at..at + 4].try_into().unwrap());
        (number(16), number(20))
    }

    #[test]
    fn svg_holds_the_texts() {
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
        two.vertical_right = Some(Axis::fit("x_o", "mm", [0.0, 2.0].into_iter(), Axis::UP));
        let text = svg(&[two]);
        for part in ["v_o (left)", "x_o (right)", "x_o, mm"] {
            assert!(text.contains(part), "{part}");
        }
    }

    #[test]
    fn png_has_signature_and_size() {
        let size = Size { width: 320, height: 240 };
        let file = render(&[wave(), wave()], Format::Png, size).unwrap();
        assert!(file.starts_with(b"\x89PNG\r\n\x1a\n"));
        assert_eq!(png_size(&file), (320, 480));
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
    fn marks_and_labels_are_written_where_there_is_room() {
        let mark = |at: f64, label: &str| Mark { at, label: label.to_owned() };
        let mut marked = wave();
        marked.marks =
            vec![mark(4.0, "k = 20 N/m"), mark(2.0, "hold"), mark(2.1, "below"), mark(2.2, "no room")];
        marked.marks.push(mark(99.0, "outside"));
        marked.channels[0].labels = vec![(499, "m = 2 kg".to_owned()), (7000, "nowhere".to_owned())];
        let text = svg(&[marked.clone()]);
        for part in ["hold", "below", "k = 20 N/m", "m = 2 kg"] {
            assert!(text.contains(&format!(">\n{part}\n<")), "{part}");
        }
        for part in ["no room", "outside", "nowhere"] {
            assert!(!text.contains(part), "{part}");
        }
        assert!(!render(&[marked], Format::Png, Size::default()).unwrap().is_empty());
    }

    /// The corners of the areas of a file.
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
        // What lies beyond the screen ends at its edge.
        let heights = areas(&banded).into_iter().map(|corners| {
            let ends =
                corners.iter().map(|at| at.1).fold([f64::MAX, f64::MIN], |[a, b], y| [a.min(y), b.max(y)]);
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
    fn what_is_faint_stands_behind_and_spans_behind_all() {
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
    fn odd_pictures_are_drawn() {
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
        odd.marks = marks.map(|at| Mark { at, label: "mark ".repeat(200) }).to_vec();
        odd.channels[1].labels = vec![(0, "label ".repeat(200)), (1, String::new())];
        odd.channels[2].labels = vec![(1, "far".to_owned())];
        odd.channels[1].errors = vec![f64::NAN, 1.0];
        odd.channels[2].errors = vec![f64::MAX, f64::INFINITY];
        odd.channels[3].errors = vec![1.0; 7];
        odd.spans = vec![[f64::NAN, 1.0], [f64::MIN, f64::MAX], [1.0, 0.0]];
        odd.channels.extend((0..40).map(|n| channel(&format!("channel number {n}"), vec![])));
        let size = Size { width: Size::LEAST, height: Size::LEAST };
        for format in [Format::Svg, Format::Png] {
            assert!(!render(&[odd.clone(), picture(vec![])], format, size).unwrap().is_empty());
        }
        assert!(!svg(&[odd]).contains('\u{1}'));
    }

    #[test]
    fn impossible_requests_are_refused() {
        let refused = |pictures: &[Picture], width| {
            let size = Size { width, height: 560 };
            render(pictures, Format::Svg, size).unwrap_err()
        };
        assert!(matches!(refused(&[], 900), PlotError::NoPictures));
        assert!(matches!(refused(&[wave()], 10), PlotError::Size(_)));
        assert!(matches!(refused(&vec![wave(); 200], 900), PlotError::TooTall { .. }));
        for (low, high, divisions) in [(0.0, f64::NAN, 8), (1.0, 1.0, 8), (0.0, 1.0, 0)] {
            let mut bad = wave();
            bad.vertical = Axis { low, high, divisions, ..bad.vertical };
            assert!(matches!(refused(&[bad], 900), PlotError::Range { .. }));
        }
    }
}
