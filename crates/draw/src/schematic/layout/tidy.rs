//! From rows and trunks to places and lines.

use super::tracks::{self, Bus};
use super::wires::{Jack, Pin, Row, Sheet, Trunk, What};
use super::{Graph, Layout, Point, Route};

/// Distance of parallel cords.
const PITCH: f64 = 10.0;

/// Room beside the outermost cord of a channel or street.
const EDGE: f64 = 12.0;

/// Room between rows without any cord.
const BETWEEN_ROWS: f64 = 24.0;

/// Where the columns of a row stand.
struct Columns {
    /// Anchors of the layers.
    layers: Vec<f64>,
    /// The place of every trunk of every channel.
    trunks: Vec<Vec<f64>>,
    width: f64,
}

/// Where the rows and the streets between them lie.
struct Floors {
    /// Upper edge of every row.
    rows: Vec<f64>,
    /// For every street, the height of every net that runs in it.
    streets: Vec<Vec<(usize, f64)>>,
    height: f64,
}

/// Gives everything its place, and draws the lines.
pub(super) fn routed(graph: &Graph, sheet: &Sheet) -> Layout {
    let columns: Vec<Columns> = (0..sheet.rows.len()).map(|row| columns(graph, sheet, row)).collect();
    let floors = floors(graph, sheet, &columns);
    let mut places = vec![(0.0, 0.0); graph.nodes.len()];
    for (index, row) in sheet.rows.iter().enumerate() {
        for (layer, items) in row.layers.iter().enumerate() {
            for item in items {
                if let What::Node(node) = row.items[*item].what {
                    places[node] = (columns[index].layers[layer], floors.rows[index] + row.items[*item].y);
                }
            }
        }
    }
    let pen = Pen { graph, sheet, columns: &columns, floors: &floors, places: &places };
    let routes = (0..graph.nets.len()).map(|_| Route::default()).collect();
    let routes = pen.drawn(routes);
    let width = columns.iter().map(|columns| columns.width).fold(0.0, f64::max);
    Layout { places, slots: sheet.slots.clone(), routes, size: (width, floors.height) }
}

/// Lines of the trunks of a channel, across it.
fn buses(graph: &Graph, sheet: &Sheet, row: usize, channel: usize) -> Vec<Bus> {
    let height = |pin: &Pin| sheet.height(graph, row, *pin);
    let bus = |trunk: &Trunk| Bus {
        before: trunk.left.iter().map(height).collect(),
        after: trunk.right.iter().map(height).collect(),
        reach: [(trunk.up, -FAR), (trunk.down, FAR)]
            .iter()
            .filter(|(goes, _)| *goes)
            .map(|(_, at)| *at)
            .collect(),
    };
    sheet.rows[row].channels[channel].iter().map(bus).collect()
}

/// Beyond the end of every row.
const FAR: f64 = 1e9;

/// Room to the left and to the right of the anchors of a layer.
fn extent(graph: &Graph, row: &Row, layer: usize) -> (f64, f64) {
    let nodes = row.layers[layer].iter().filter_map(|item| match row.items[*item].what {
        What::Node(node) => Some(graph.nodes[node].area),
        What::Through(_) => None,
    });
    nodes.fold((0.0, 0.0), |(left, right), area| (f64::max(left, -area.left), f64::max(right, area.right)))
}

/// Channels of neighbouring rows have their tracks on different places, so that what comes into a street from
/// above is never in line with what comes from below.
fn columns(graph: &Graph, sheet: &Sheet, row: usize) -> Columns {
    let shift = if row % 2 == 1 { PITCH / 2.0 } else { 0.0 };
    let mut columns = Columns { layers: Vec::new(), trunks: Vec::new(), width: 0.0 };
    let mut x = 0.0;
    for channel in 0..sheet.rows[row].channels.len() {
        let buses = buses(graph, sheet, row, channel);
        let (tracks, count) = tracks::assign(&buses);
        let first = ((x + EDGE - shift) / PITCH).ceil() * PITCH + shift;
        let place =
            |(bus, track): (&Bus, usize)| if bus.is_straight() { x } else { first + track as f64 * PITCH };
        columns.trunks.push(buses.iter().zip(tracks).map(place).collect());
        x = if count == 0 { x + EDGE } else { first + (count - 1) as f64 * PITCH + EDGE };
        if channel < sheet.rows[row].layers.len() {
            let (left, right) = extent(graph, &sheet.rows[row], channel);
            columns.layers.push((x + left).ceil());
            x = (x + left).ceil() + right.ceil();
        }
    }
    columns.width = x;
    columns
}

/// The trunks of a row that go on to a street, with their places.
fn leaving<'a>(row: &'a Row, columns: &'a Columns, below: bool) -> impl Iterator<Item = (usize, f64)> + 'a {
    let all = row.channels.iter().zip(&columns.trunks);
    let all = all.flat_map(|(trunks, places)| trunks.iter().zip(places));
    all.filter(move |(trunk, _)| if below { trunk.down } else { trunk.up }).map(|(trunk, x)| (trunk.net, *x))
}

fn floors(graph: &Graph, sheet: &Sheet, columns: &[Columns]) -> Floors {
    let mut floors = Floors { rows: Vec::new(), streets: Vec::new(), height: 0.0 };
    let mut y = 0.0;
    for street in 0..=sheet.rows.len() {
        let (nets, buses) = street_buses(sheet, columns, street);
        let (tracks, count) = tracks::assign(&buses);
        let heights = nets.iter().zip(tracks).map(|(net, track)| (*net, y + EDGE + track as f64 * PITCH));
        floors.streets.push(heights.collect());
        y += match count {
            0 if street == 0 || street == sheet.rows.len() => 0.0,
            0 => BETWEEN_ROWS,
            count => 2.0 * EDGE + (count - 1) as f64 * PITCH,
        };
        if let Some(row) = sheet.rows.get(street) {
            floors.rows.push(y);
            y += row_height(graph, row);
        }
    }
    floors.height = y;
    floors
}

fn row_height(graph: &Graph, row: &Row) -> f64 {
    let bottom = |item: &super::wires::Item| match item.what {
        What::Node(node) => item.y + graph.nodes[node].area.bottom,
        What::Through(_) => item.y,
    };
    row.items.iter().map(bottom).fold(0.0, f64::max).ceil()
}

/// The nets of a street, and their lines.
fn street_buses(sheet: &Sheet, columns: &[Columns], street: usize) -> (Vec<usize>, Vec<Bus>) {
    let mut buses: std::collections::BTreeMap<usize, Bus> = std::collections::BTreeMap::new();
    if let Some(above) = street.checked_sub(1) {
        for (net, x) in leaving(&sheet.rows[above], &columns[above], true) {
            buses.entry(net).or_default().before.push(x);
        }
    }
    if let Some(row) = sheet.rows.get(street) {
        for (net, x) in leaving(row, &columns[street], false) {
            buses.entry(net).or_default().after.push(x);
        }
    }
    buses.into_iter().unzip()
}

struct Pen<'a> {
    graph: &'a Graph,
    sheet: &'a Sheet,
    columns: &'a [Columns],
    floors: &'a Floors,
    places: &'a [Point],
}

impl Pen<'_> {
    fn drawn(&self, mut routes: Vec<Route>) -> Vec<Route> {
        for (index, row) in self.sheet.rows.iter().enumerate() {
            for (channel, trunks) in row.channels.iter().enumerate() {
                for (trunk, x) in trunks.iter().zip(&self.columns[index].trunks[channel]) {
                    self.trunk(index, channel, trunk, *x, &mut routes[trunk.net].lines);
                }
            }
        }
        for street in 0..self.floors.streets.len() {
            self.street(street, &mut routes);
        }
        for route in &mut routes {
            route.lines = joined(&route.lines);
            route.dots = dots(&route.lines);
        }
        let uprights: Vec<[Point; 2]> = routes.iter().flat_map(|route| &route.lines).copied().collect();
        let uprights: Vec<_> = uprights.into_iter().filter(|[a, b]| a.0 == b.0).collect();
        (0..self.floors.streets.len()).for_each(|street| self.arrows(street, &uprights, &mut routes));
        routes
    }

    /// The upright line and what leads to it from both sides.
    fn trunk(&self, row: usize, channel: usize, trunk: &Trunk, x: f64, lines: &mut Vec<[Point; 2]>) {
        let top = self.floors.rows[row];
        let height = |pin: Pin| top + self.sheet.height(self.graph, row, pin);
        let mut heights: Vec<f64> = trunk.pins().map(height).collect();
        let street = |street: usize| self.street_height(street, trunk.net);
        heights.extend(
            [(trunk.up, row), (trunk.down, row + 1)]
                .iter()
                .filter(|(goes, _)| *goes)
                .filter_map(|(_, at)| street(*at)),
        );
        let (low, high) = heights
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(*y), high.max(*y)));
        if low < high {
            lines.push([(x, low), (x, high)]);
        }
        for (pin, layer) in trunk
            .left
            .iter()
            .map(|pin| (*pin, channel.wrapping_sub(1)))
            .chain(trunk.right.iter().map(|pin| (*pin, channel)))
        {
            let from = self.pin_x(row, layer, pin);
            lines.push([(from.min(x), height(pin)), (from.max(x), height(pin))]);
        }
    }

    /// Where a pin is along its layer; a net that passes through is met in the middle.
    fn pin_x(&self, row: usize, layer: usize, pin: Pin) -> f64 {
        let middle = self.columns[row].layers.get(layer).copied().unwrap_or(0.0);
        let What::Node(node) = self.sheet.rows[row].items[pin.item].what else { return middle };
        let jack = match pin.jack {
            Jack::Input(input) => self.graph.nodes[node].inputs[self.sheet.slots[node][input]],
            Jack::Output(outlet) => self.graph.nodes[node].outputs[outlet],
            Jack::Through => return middle,
        };
        self.places[node].0 + jack.0
    }

    fn street_height(&self, street: usize, net: usize) -> Option<f64> {
        self.floors.streets[street].iter().find(|(other, _)| *other == net).map(|(_, y)| *y)
    }

    fn street(&self, street: usize, routes: &mut [Route]) {
        let (nets, buses) = street_buses(self.sheet, self.columns, street);
        for (net, bus) in nets.into_iter().zip(buses) {
            let (left, right) = bus.ends();
            let Some(y) = self.street_height(street, net).filter(|_| left < right) else { continue };
            routes[net].lines.push([(left, y), (right, y)]);
        }
    }

    /// Arrows on what runs back in a street, clear of the lines that cross it.
    fn arrows(&self, street: usize, uprights: &[[Point; 2]], routes: &mut [Route]) {
        let (nets, buses) = street_buses(self.sheet, self.columns, street);
        for (net, bus) in nets.into_iter().zip(buses) {
            let Some(y) = self.street_height(street, net) else { continue };
            let here = uprights.iter().filter(|[top, bottom]| (top.1..=bottom.1).contains(&y));
            let crossing: Vec<f64> = here.map(|[top, _]| top.0).collect();
            let from = self.places[self.graph.nets[net].from].0;
            routes[net].arrows.extend(arrow(&bus, from, &crossing).map(|x| (x, y)));
        }
    }
}

/// Room that an arrow needs to either side of its place.
const ARROW: f64 = 7.0;

/// Near the middle of the longest stretch of a street that runs back and has room beside what crosses it.
fn arrow(bus: &Bus, source: f64, crossing: &[f64]) -> Option<f64> {
    let mut stops: Vec<f64> =
        bus.before.iter().chain(&bus.after).copied().filter(|x| *x <= source + FAR).collect();
    stops.sort_by(f64::total_cmp);
    let from = stops.iter().copied().filter(|x| *x > source).fold(f64::INFINITY, f64::min);
    let mut back: Vec<_> = stops.windows(2).filter(|pair| pair[1] <= from).collect();
    back.sort_by(|a, b| (b[1] - b[0]).total_cmp(&(a[1] - a[0])));
    let long = back.into_iter().filter(|pair| pair[1] - pair[0] > 4.0 * PITCH);
    let is_clear = |x: &f64| crossing.iter().all(|other| (x - other).abs() >= ARROW);
    let mut near = long.flat_map(|pair| {
        let (middle, far) = ((pair[0] + pair[1]) / 2.0, (pair[1] - pair[0]) / 2.0);
        (0..far as i32).flat_map(move |step| [middle - f64::from(step), middle + f64::from(step)])
    });
    near.find(is_clear)
}

/// Lines with those that touch in one direction made into one.
fn joined(lines: &[[Point; 2]]) -> Vec<[Point; 2]> {
    let level = lines.iter().filter(|[a, b]| a.1 == b.1 && a.0 != b.0).map(|[a, b]| (a.1, a.0, b.0));
    let upright = lines.iter().filter(|[a, b]| a.0 == b.0 && a.1 != b.1).map(|[a, b]| (a.0, a.1, b.1));
    let level = stretches(level.collect()).into_iter().map(|(y, from, to)| [(from, y), (to, y)]);
    let upright = stretches(upright.collect()).into_iter().map(|(x, from, to)| [(x, from), (x, to)]);
    level.chain(upright).collect()
}

/// A stretch of a line: where the line is, and from where to where it goes.
type Stretch = (f64, f64, f64);

fn stretches(mut parts: Vec<Stretch>) -> Vec<Stretch> {
    parts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut whole: Vec<Stretch> = Vec::new();
    for part in parts {
        match whole.last_mut() {
            Some(last) if last.0 == part.0 && part.1 <= last.2 => last.2 = last.2.max(part.2),
            _ => whole.push(part),
        }
    }
    whole
}

/// Where lines of a net meet in three or four directions.
fn dots(lines: &[[Point; 2]]) -> Vec<Point> {
    let mut dots = Vec::new();
    let is_level = |line: &&[Point; 2]| line[0].1 == line[1].1;
    for level in lines.iter().filter(is_level) {
        for upright in lines.iter().filter(|line| !is_level(line)) {
            let at = (upright[0].0, level[0].1);
            let ways = [at.0 > level[0].0, at.0 < level[1].0, at.1 > upright[0].1, at.1 < upright[1].1];
            let touches =
                (level[0].0..=level[1].0).contains(&at.0) && (upright[0].1..=upright[1].1).contains(&at.1);
            if touches && ways.iter().filter(|way| **way).count() > 2 {
                dots.push(at);
            }
        }
    }
    dots
}
