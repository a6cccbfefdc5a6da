//! Frequency response from a drive to a signal, or between two signals that a drive moves.

use std::f64::consts::{PI, TAU};
use std::io::Write;

use nalgebra::{Complex, DMatrix, DVector};

use super::LinearError;
use super::roots::{Root, Stability, check, roots};
use patchcord_core::document::suggestion;
use patchcord_core::ir::{Port, StateSpace};

/// The way from a drive to a signal of a linear model.
#[derive(Debug, Clone)]
pub struct Transfer<'m> {
    model: &'m StateSpace,
    input: usize,
    /// The part of the model that is fed back, column by column through states and delay lines.
    inner: DMatrix<Complex<f64>>,
    /// What the drive does to states and delay lines.
    from_drive: DVector<Complex<f64>>,
    output: Outlet<'m>,
    /// The signal that the other is held against, where it is not the drive.
    against: Option<Outlet<'m>>,
}

/// A signal, with what states, delay lines and the drive do to it.
#[derive(Debug, Clone)]
struct Outlet<'m> {
    port: &'m Port,
    by_inner: DVector<Complex<f64>>,
    direct: f64,
}

impl<'m> Outlet<'m> {
    fn new(model: &'m StateSpace, input: usize, signal: &str) -> Result<Self, LinearError> {
        let output = model.outputs.iter().position(|port| port.name == signal).ok_or_else(|| {
            LinearError::UnknownSignal {
                name: signal.to_owned(),
                hint: hint(signal, &model.outputs, "no signal"),
            }
        })?;
        let inner = model.states.len() + model.delays.len();
        let row = model.matrix.row(inner + output);
        let by_inner = DVector::from_fn(inner, |column, _| Complex::from(row[column]));
        Ok(Outlet { port: &model.outputs[output], by_inner, direct: row[inner + input] })
    }

    fn swing(&self, inner: &DVector<Complex<f64>>) -> Complex<f64> {
        self.by_inner.dot(inner) + self.direct
    }
}

/// A stretch of frequencies, in Hz.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// The lowest, 1e-100 or above.
    pub low: f64,
    /// The highest, above the lowest, 1e100 or below.
    pub high: f64,
}

/// How a signal follows a drive that swings, over a band of frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Name of the drive, of the signal that reads it, or of the signal that the other is held against.
    pub input: String,
    /// Name of the drive that moves both, where that is another.
    pub by: Option<String>,
    /// Name of the signal.
    pub output: String,
    /// What the ratio is in: the signal's unit per the input's, empty where these are the same.
    pub unit: String,
    /// By rising frequency.
    pub points: Vec<ResponsePoint>,
}

/// The response at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResponsePoint {
    /// In Hz.
    pub frequency: f64,
    /// Amplitude of the signal over that of the input, in the response's unit; not finite at an undamped resonance,
    /// or where the input stands still.
    pub ratio: f64,
    /// Lead of the signal on the input in radians, going on without jumps from the first point, which lies within
    /// -pi ... pi. Across an undamped resonance it falls by pi.
    pub phase: f64,
}

impl ResponsePoint {
    /// 20 log10 of the ratio.
    pub fn decibels(&self) -> f64 {
        20.0 * self.ratio.log10()
    }
}

impl Response {
    /// What it is of, in words.
    pub fn title(&self) -> String {
        let by = self.by.as_ref().map(|drive| format!(", moved by {drive}")).unwrap_or_default();
        format!("{} from {}{by}", self.output, self.input)
    }

    /// Writes a table: units in `#` comment lines, then the columns `frequency` in Hz, `ratio`, `decibels` and `phase`
    /// in degrees. Numbers read back to the same bits.
    ///
    /// # Errors
    /// When the writer refuses.
    pub fn write_csv(&self, mut to: impl Write) -> std::io::Result<()> {
        let unit = if self.unit.is_empty() { "1" } else { &self.unit };
        writeln!(to, "# frequency: Hz\n# ratio, {}: {unit}\n# decibels: dB\n# phase: deg", self.title())?;
        writeln!(to, "frequency,ratio,decibels,phase")?;
        for point in &self.points {
            let ResponsePoint { frequency, ratio, phase } = point;
            writeln!(to, "{frequency:?},{ratio:?},{:?},{:?}", point.decibels(), phase.to_degrees())?;
        }
        Ok(())
    }
}

impl<'m> Transfer<'m> {
    /// The way between a drive and a signal, by name; the signal may be an element or a drive, and the drive a
    /// signal that reads it.
    ///
    /// # Errors
    /// When one of them does not exist, or a derivative is not a number.
    pub fn new(model: &'m StateSpace, drive: &str, signal: &str) -> Result<Self, LinearError> {
        let input = model.inputs.iter().position(|port| port.name == drive).ok_or_else(|| {
            LinearError::NotADrive { name: drive.to_owned(), hint: hint(drive, &model.inputs, "no drive") }
        })?;
        let output = Outlet::new(model, input, signal)?;
        check(model)?;
        let inner = model.states.len() + model.delays.len();
        let matrix = model.matrix.map(Complex::from);
        Ok(Transfer {
            model,
            input,
            inner: matrix.view((0, 0), (inner, inner)).into_owned(),
            from_drive: matrix.view((0, inner + input), (inner, 1)).column(0).into_owned(),
            output,
            against: None,
        })
    }

    /// The way between two signals that the drive moves, by names as for [`Transfer::new`]: the quotient of the ways to
    /// the second and to the first.
    ///
    /// # Errors
    /// When one of them does not exist, or a derivative is not a number.
    pub fn between(
        model: &'m StateSpace,
        drive: &str,
        first: &str,
        second: &str,
    ) -> Result<Self, LinearError> {
        let to_second = Transfer::new(model, drive, second)?;
        let against = Some(Outlet::new(model, to_second.input, first)?);
        Ok(Transfer { against, ..to_second })
    }

    /// The complex ratio at s = j omega, in volts per volt: `by_inner (P - inner)^-1 from_drive + direct`, with s for
    /// every state and e^(s T) for every delay line on the diagonal of P; between two signals the quotient of theirs.
    /// Exact for delays, also within loops. Not finite at an undamped resonance, or where the first signal stands still.
    /// `omega` in rad/s, above 0.
    pub fn volts_per_volt(&self, omega: f64) -> Complex<f64> {
        let mut system = -self.inner.clone();
        let states = self.model.states.iter().map(|_| Complex::new(0.0, omega));
        let delays = self.model.delays.iter().map(|delay| Complex::new(0.0, omega * delay.seconds).exp());
        for (index, term) in states.chain(delays).enumerate() {
            system[(index, index)] += term;
        }
        let Some(inner) = system.lu().solve(&self.from_drive) else {
            return Complex::new(f64::INFINITY, 0.0);
        };
        let swing = self.output.swing(&inner);
        self.against.as_ref().map_or(swing, |against| swing / against.swing(&inner))
    }

    /// The response over a band: both ends, 60 points a decade, natural frequencies, and more where it turns quickly.
    ///
    /// # Errors
    /// When the band is none, delays turn the phase too often within it, or a signal does not follow the drive.
    pub fn over(&self, band: Band) -> Result<Response, LinearError> {
        band.check()?;
        let drive = &self.model.inputs[self.input];
        let (from, to) = (self.against.as_ref().map_or(drive, |against| against.port), self.output.port);
        let factor = to.per_volt / from.per_volt;
        let mut points = Vec::new();
        let mut phase = Unwrapped::default();
        for (frequency, ratio) in self.sampled(band)? {
            let ratio = ratio * factor;
            points.push(ResponsePoint { frequency, ratio: ratio.norm(), phase: phase.next(ratio) });
        }
        let stands = |still: &Port| {
            Err(LinearError::NotMoved { input: drive.name.clone(), output: still.name.clone() })
        };
        if self.against.is_some() && points.iter().all(|point| !point.ratio.is_finite()) {
            return stands(from);
        }
        if points.iter().all(|point| point.ratio == 0.0) {
            return stands(to);
        }
        let unit =
            if from.unit == to.unit { String::new() } else { format!("{} per {}", to.unit, from.unit) };
        let by = (from.name != drive.name).then(|| drive.name.clone());
        Ok(Response { input: from.name.clone(), by, output: to.name.clone(), unit, points })
    }

    /// The ratios at frequencies, in Hz, so near to each other that a curve can be drawn through them.
    fn sampled(&self, band: Band) -> Result<Vec<(f64, Complex<f64>)>, LinearError> {
        let grid = self.grid(band)?;
        let at = |frequency: f64| (frequency, self.volts_per_volt(TAU * frequency));
        let mut all = vec![at(grid[0])];
        for frequency in &grid[1..] {
            let begin = all[all.len() - 1];
            self.refine(begin, at(*frequency), MOST_HALVINGS, &mut all);
        }
        Ok(all)
    }

    /// Frequencies by equal ratios and those at which it rings, but with no more than an eighth of a turn of the delays
    /// between two.
    fn grid(&self, band: Band) -> Result<Vec<f64>, LinearError> {
        let Band { low, high } = band;
        let seconds: f64 = self.model.delays.iter().map(|delay| delay.seconds).sum();
        let turns = high * seconds;
        if turns > MOST_TURNS {
            return Err(LinearError::TooManyTurns { high, turns, most: MOST_TURNS });
        }
        let count = (PER_DECADE * (high / low).log10()).ceil().max(1.0);
        let even = (0..count as usize).map(|index| low * (high / low).powf(index as f64 / count));
        let mut wanted: Vec<f64> = even.chain([high]).chain(self.ringing(band)).collect();
        wanted.sort_by(f64::total_cmp);
        let mut grid: Vec<f64> = Vec::new();
        for frequency in wanted {
            let begin = grid.last().copied().unwrap_or(frequency);
            let parts = ((frequency - begin) * seconds * 8.0).ceil().max(1.0);
            grid.extend((1..parts as usize).map(|part| begin + (frequency - begin) * part as f64 / parts));
            grid.push(frequency);
        }
        Ok(grid)
    }

    /// The natural frequencies within a band at which it rings; of what is not damped there is no response there.
    fn ringing(&self, Band { low, high }: Band) -> impl Iterator<Item = f64> {
        let damped = |root: &Root| root.imaginary > 0.0 && root.stability() != Stability::Neutral;
        let natural = roots(self.model).unwrap_or_default().into_iter().filter(damped);
        natural.map(|root| root.hertz()).filter(move |frequency| low < *frequency && *frequency < high)
    }

    /// Adds the point at the end of a stretch, and before it those in between as long as the curve bends within it.
    fn refine(
        &self,
        begin: (f64, Complex<f64>),
        end: (f64, Complex<f64>),
        halvings: usize,
        all: &mut Vec<(f64, Complex<f64>)>,
    ) {
        if halvings > 0 && is_far(begin.1, end.1) {
            let frequency = (begin.0 * end.0).sqrt();
            let middle = (frequency, self.volts_per_volt(TAU * frequency));
            self.refine(begin, middle, halvings - 1, all);
            self.refine(middle, end, halvings - 1, all);
        } else {
            all.push(end);
        }
    }
}

const PER_DECADE: f64 = 60.0;
/// Frequencies, in Hz, of which the squares are numbers, by which complex numbers are divided.
const LOWEST: f64 = 1e-100;
const HIGHEST: f64 = 1e100;
/// The phase of delays may turn so often within a band.
const MOST_TURNS: f64 = 1e4;
/// A stretch between two frequencies of the grid is halved so often at most: to 1e-5 of a frequency.
const MOST_HALVINGS: usize = 12;
/// Neighbouring points are as near as this, as a ratio of their difference to the larger: about 1 dB, 6 degrees.
const NEAR: f64 = 0.1;

fn is_far(one: Complex<f64>, other: Complex<f64>) -> bool {
    let largest = one.norm().max(other.norm());
    (one - other).norm() > NEAR * largest
}

/// Phases that go on without jumps.
#[derive(Default)]
struct Unwrapped {
    last: Option<f64>,
}

/// Half a turn, but for rounding, is counted downward: which way it goes is not to hang on rounding.
const HALF_TURN: f64 = 1e-6;

impl Unwrapped {
    fn next(&mut self, ratio: Complex<f64>) -> f64 {
        if ratio.norm() == 0.0 || !ratio.is_finite() {
            return f64::NAN;
        }
        let phase = match self.last {
            None => first(ratio.arg()),
            Some(last) => last + turned(ratio.arg() - last),
        };
        self.last = Some(phase);
        phase
    }
}

/// Half a turn at the beginning is one ahead.
fn first(phase: f64) -> f64 {
    if phase + PI < HALF_TURN { phase + TAU } else { phase }
}

/// The same angle within -pi ... pi.
fn turned(angle: f64) -> f64 {
    angle - TAU * ((angle + PI + HALF_TURN) / TAU).floor()
}

impl Band {
    /// Whether there are frequencies in it.
    ///
    /// # Errors
    /// When it does not go from a frequency to a higher one, both within 1e-100 ... 1e100 Hz.
    pub fn check(self) -> Result<(), LinearError> {
        let Band { low, high } = self;
        let is_band = LOWEST <= low && low < high && high <= HIGHEST;
        if is_band { Ok(()) } else { Err(LinearError::NotABand { low, high }) }
    }

    /// A decade beyond the slowest and the fastest root and delay line, in whole decades; 0.01 ... 100 Hz where there
    /// are neither.
    pub fn around(roots: &[Root], model: &StateSpace) -> Band {
        let natural = roots.iter().map(Root::hertz);
        let delays = model.delays.iter().map(|delay| 1.0 / (TAU * delay.seconds));
        let (low, high) = natural
            .chain(delays)
            .filter(|frequency| *frequency > 0.0)
            .fold((f64::INFINITY, 0.0f64), |(low, high), frequency| {
                (low.min(frequency), high.max(frequency))
            });
        let (low, high) = if high > 0.0 { (low, high) } else { (0.1, 10.0) };
        let decade = |exponent: f64| 10f64.powi(exponent as i32);
        Band { low: decade(low.log10().floor() - 1.0), high: decade(high.log10().ceil() + 1.0) }
    }
}

fn hint(name: &str, ports: &[Port], none: &str) -> String {
    let known: Vec<&str> = ports.iter().map(|port| port.name.as_str()).collect();
    suggestion(name, &known).unwrap_or_else(|| format!("the patch has {none}"))
}
