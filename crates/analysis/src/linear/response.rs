//! Frequency response from a drive to a signal, or between two signals that depend on the same drive.
//!
//! A transfer function is evaluated exactly at each frequency, with delays, by solving a complex linear system. The
//! frequencies start as an even logarithmic grid with the natural frequencies added. Intervals in which the response
//! changes quickly are halved.

use std::f64::consts::TAU;
use std::io::Write;

use nalgebra::{Complex, DMatrix, DVector};

use super::LinearError;
use super::band::FrequencyBand;
use super::phase::PhaseUnwrapper;
use super::roots::{Root, Stability, check_derivatives, roots};
use patchcord_core::document::suggestion;
use patchcord_core::ir::{Port, StateSpace};

/// The transfer function from a drive to a signal of a linear model, or the quotient of two of them.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::linear::{FrequencyBand, LinearError, TransferFunction};
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::Patch;
/// use patchcord_core::solve::Machine;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let patch = Patch::read("../../patches/lessons/driven-oscillator.json")?;
/// let program = Program::new(&Circuit::new(&patch)?)?;
/// let model = Machine::new(&program, 1e-3)?.state_space();
///
/// let transfer = TransferFunction::new(&model, "push", "x")?;
/// let response = transfer.response(FrequencyBand { low: 0.1, high: 10.0 })?;
/// assert_eq!((response.title().as_str(), response.unit.as_str()), ("x from push", "mm per N"));
///
/// // |x / F| = 1 / |k - m w^2 + j d w|, in mm per N
/// let (first, omega) = (response.points[0], 0.2 * std::f64::consts::PI);
/// assert!((first.ratio * (40.0 - omega * omega).hypot(2.0 * omega) - 1e3).abs() < 1e-6);
/// assert!(matches!(TransferFunction::new(&model, "x", "x"), Err(LinearError::NotADrive { .. })));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct TransferFunction<'m> {
    /// The linear model.
    model: &'m StateSpace,
    /// Index of the drive.
    input: usize,
    /// The square part of the model's matrix for states and delay lines.
    inner: DMatrix<Complex<f64>>,
    /// Influence of the drive on states and delay lines.
    from_drive: DVector<Complex<f64>>,
    /// The signal in the numerator.
    output: OutputRow<'m>,
    /// The signal in the denominator; None if the denominator is the drive.
    denominator: Option<OutputRow<'m>>,
}

/// A signal as a linear function of states, delay lines and the drive.
#[derive(Debug, Clone)]
struct OutputRow<'m> {
    /// Name, unit and scale of the signal.
    port: &'m Port,
    /// Influence of states and delay lines, in volts per volt.
    by_inner: DVector<Complex<f64>>,
    /// Direct influence of the drive, in volts per volt.
    direct: f64,
}

impl<'m> OutputRow<'m> {
    /// The row of a signal, by name. `input` is the index of the drive.
    fn new(model: &'m StateSpace, input: usize, signal: &str) -> Result<Self, LinearError> {
        let output = model.outputs.iter().position(|port| port.name == signal).ok_or_else(|| {
            LinearError::UnknownSignal {
                name: signal.to_owned(),
                hint: hint(signal, &model.outputs, "no signal"),
            }
        })?;
        let inner = model.states.len() + model.delays.len();
        let row = &model.matrix[inner + output];
        let by_inner = DVector::from_fn(inner, |column, _| Complex::from(row[column]));
        Ok(OutputRow { port: &model.outputs[output], by_inner, direct: row[inner + input] })
    }

    /// Complex amplitude of the signal for given amplitudes of states and delay lines and a unit drive.
    fn amplitude(&self, inner: &DVector<Complex<f64>>) -> Complex<f64> {
        self.by_inner.dot(inner) + self.direct
    }
}

/// The frequency response of a signal over a band.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::linear::{FrequencyResponse, ResponsePoint};
///
/// let (input, output) = ("force".to_owned(), "x".to_owned());
/// let points = vec![ResponsePoint { frequency: 1.0, ratio: 10.0, phase: 0.0 }];
/// let response = FrequencyResponse { input, output, by: Some("E1".to_owned()), unit: "m/N".to_owned(), points };
/// assert_eq!(response.title(), "x from force, moved by E1");
/// assert!((response.points[0].decibels() - 20.0).abs() < 1e-12);
///
/// let mut csv = Vec::new();
/// response.write_csv(&mut csv)?;
/// assert!(csv.starts_with(b"# frequency: Hz\n"));
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyResponse {
    /// Name of the drive, of the signal that reads it, or of the signal in the denominator.
    pub input: String,
    /// Name of the drive if `input` is a signal that depends on it. None if `input` is the drive.
    pub by: Option<String>,
    /// Name of the signal.
    pub output: String,
    /// Unit of the ratio, such as "m per V"; empty if both units are equal.
    pub unit: String,
    /// The points in order of frequency.
    pub points: Vec<ResponsePoint>,
}

/// The frequency response at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResponsePoint {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Amplitude of the output divided by that of the input, in the unit of the response. Not finite at an undamped
    /// resonance, or if the input does not move.
    pub ratio: f64,
    /// Phase lead of the output in radians, continuous over frequency. The first point is within -pi ... pi. The phase
    /// falls by pi at an undamped resonance. NaN if the ratio is 0 or not finite.
    pub phase: f64,
}

impl ResponsePoint {
    /// The ratio in decibels: 20 log10(ratio).
    pub fn decibels(&self) -> f64 {
        20.0 * self.ratio.log10()
    }
}

impl FrequencyResponse {
    /// A title such as "x from force, moved by E1".
    pub fn title(&self) -> String {
        let by = self.by.as_ref().map(|drive| format!(", moved by {drive}")).unwrap_or_default();
        format!("{} from {}{by}", self.output, self.input)
    }

    /// Writes CSV: units in `#` comment lines, then the columns `frequency` in Hz, `ratio`, `decibels` and `phase` in
    /// degrees. Numbers are exact. A point without decibels or a phase has no row: its ratio is 0 or not finite.
    ///
    /// # Errors
    /// If the writer returns an error.
    pub fn write_csv(&self, mut to: impl Write) -> std::io::Result<()> {
        let unit = if self.unit.is_empty() { "1" } else { &self.unit };
        writeln!(to, "# frequency: Hz\n# ratio, {}: {unit}\n# decibels: dB\n# phase: deg", self.title())?;
        writeln!(to, "frequency,ratio,decibels,phase")?;
        for point in self.points.iter().filter(|point| point.decibels().is_finite()) {
            let ResponsePoint { frequency, ratio, phase } = point;
            writeln!(to, "{frequency:?},{ratio:?},{:?},{:?}", point.decibels(), phase.to_degrees())?;
        }
        Ok(())
    }
}

impl<'m> TransferFunction<'m> {
    /// The transfer function from a drive to a signal, by name. An element or a drive may be used as the signal, and a
    /// signal that reads a drive as the drive.
    ///
    /// # Errors
    /// If a name does not exist, or a derivative is not finite.
    pub fn new(model: &'m StateSpace, drive: &str, signal: &str) -> Result<Self, LinearError> {
        let input = model.inputs.iter().position(|port| port.name == drive).ok_or_else(|| {
            LinearError::NotADrive { name: drive.to_owned(), hint: hint(drive, &model.inputs, "no drive") }
        })?;
        let output = OutputRow::new(model, input, signal)?;
        check_derivatives(model)?;
        let inner = model.states.len() + model.delays.len();
        Ok(TransferFunction {
            model,
            input,
            inner: DMatrix::from_fn(inner, inner, |row, column| Complex::from(model.matrix[row][column])),
            from_drive: DVector::from_fn(inner, |row, _| Complex::from(model.matrix[row][inner + input])),
            output,
            denominator: None,
        })
    }

    /// The transfer function from a first to a second signal: the quotient of the transfer functions from the drive to
    /// both. Names are as for [`TransferFunction::new`].
    ///
    /// # Errors
    /// If a name does not exist, or a derivative is not finite.
    pub fn between(
        model: &'m StateSpace,
        drive: &str,
        first: &str,
        second: &str,
    ) -> Result<Self, LinearError> {
        let to_second = TransferFunction::new(model, drive, second)?;
        let denominator = Some(OutputRow::new(model, to_second.input, first)?);
        Ok(TransferFunction { denominator, ..to_second })
    }

    /// The complex ratio at s = j omega, in volts per volt.
    ///
    /// It is `by_inner (P - inner)^-1 from_drive + direct`. P is diagonal with s for every state and e^(s T) for every
    /// delay line, so delays are exact, also within loops. Between two signals it is the quotient of two such terms.
    /// Not finite at an undamped resonance, or if the first signal does not move. `omega` is in rad/s, positive.
    pub fn volts_per_volt(&self, omega: f64) -> Complex<f64> {
        let Some(inner) = self.inner_amplitudes(omega) else {
            return Complex::new(f64::INFINITY, 0.0);
        };
        let output = self.output.amplitude(&inner);
        self.denominator.as_ref().map_or(output, |denominator| output / denominator.amplitude(&inner))
    }

    /// Complex amplitudes of states and delay lines for a unit drive. None at an undamped resonance. `omega` is in
    /// rad/s.
    fn inner_amplitudes(&self, omega: f64) -> Option<DVector<Complex<f64>>> {
        // The decomposition of an empty matrix panics.
        if self.inner.is_empty() {
            return Some(self.from_drive.clone());
        }
        let mut system = -self.inner.clone();
        let states = self.model.states.iter().map(|_| Complex::new(0.0, omega));
        let delays = self.model.delays.iter().map(|delay| Complex::new(0.0, omega * delay.seconds).exp());
        for (index, term) in states.chain(delays).enumerate() {
            system[(index, index)] += term;
        }
        system.lu().solve(&self.from_drive)
    }

    /// The frequency response over a band: both limits, 60 points per decade, the natural frequencies, and more points
    /// where the response changes quickly.
    ///
    /// # Errors
    /// If the band is invalid, delays turn the phase too often within it, or a signal does not depend on the drive.
    pub fn response(&self, band: FrequencyBand) -> Result<FrequencyResponse, LinearError> {
        band.check()?;
        let drive = &self.model.inputs[self.input];
        let (from, to) =
            (self.denominator.as_ref().map_or(drive, |denominator| denominator.port), self.output.port);
        let factor = to.per_volt / from.per_volt;
        let mut points = Vec::new();
        let mut phase = PhaseUnwrapper::default();
        for (frequency, ratio) in self.sampled(band)? {
            let ratio = ratio * factor;
            points.push(ResponsePoint { frequency, ratio: ratio.norm(), phase: phase.next(ratio) });
        }
        let no_influence = |constant: &Port| {
            Err(LinearError::NoInfluence { input: drive.name.clone(), output: constant.name.clone() })
        };
        if self.denominator.is_some() && points.iter().all(|point| !point.ratio.is_finite()) {
            return no_influence(from);
        }
        if points.iter().all(|point| point.ratio == 0.0) {
            return no_influence(to);
        }
        let unit =
            if from.unit == to.unit { String::new() } else { format!("{} per {}", to.unit, from.unit) };
        let by = (from.name != drive.name).then(|| drive.name.clone());
        Ok(FrequencyResponse { input: from.name.clone(), by, output: to.name.clone(), unit, points })
    }

    /// Frequencies in Hz and complex ratios, dense enough for a curve through them.
    fn sampled(&self, band: FrequencyBand) -> Result<Vec<(f64, Complex<f64>)>, LinearError> {
        let grid = self.grid(band)?;
        let at = |frequency: f64| (frequency, self.volts_per_volt(TAU * frequency));
        let mut all = vec![at(grid[0])];
        for frequency in &grid[1..] {
            let begin = all[all.len() - 1];
            self.refine(begin, at(*frequency), MAX_HALVINGS, &mut all);
        }
        Ok(all)
    }

    /// The initial frequencies: equal ratios and the natural frequencies. Further points limit the phase that the delay
    /// lines turn between two of them to an eighth of a turn.
    fn grid(&self, band: FrequencyBand) -> Result<Vec<f64>, LinearError> {
        let FrequencyBand { low, high } = band;
        let seconds: f64 = self.model.delays.iter().map(|delay| delay.seconds).sum();
        let turns = high * seconds;
        if turns > MAX_TURNS {
            return Err(LinearError::TooManyTurns { high, turns, max: MAX_TURNS });
        }
        let count = (POINTS_PER_DECADE * (high / low).log10()).ceil().max(1.0);
        let even = (0..count as usize).map(|index| low * (high / low).powf(index as f64 / count));
        let mut wanted: Vec<f64> = even.chain([high]).chain(self.natural_frequencies(band)).collect();
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

    /// The natural frequencies within a band. Undamped ones are omitted, because the response is not finite there.
    fn natural_frequencies(&self, FrequencyBand { low, high }: FrequencyBand) -> impl Iterator<Item = f64> {
        let damped = |root: &Root| root.imaginary > 0.0 && root.stability() != Stability::Neutral;
        let natural = roots(self.model).unwrap_or_default().into_iter().filter(damped);
        natural.map(|root| root.hertz()).filter(move |frequency| low < *frequency && *frequency < high)
    }

    /// Appends the point at the end of an interval, after points inside it if the response changes quickly.
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

/// Points per decade of the initial grid.
const POINTS_PER_DECADE: f64 = 60.0;
/// The largest number of turns of the phase by delay lines within a band.
const MAX_TURNS: f64 = 1e4;
/// The largest number of times that an interval of the grid is halved. This resolves 1e-5 of a frequency.
const MAX_HALVINGS: usize = 12;
/// The largest difference of neighbouring points as a fraction of the larger one: about 1 dB or 6 degrees.
const MAX_CHANGE: f64 = 0.1;

/// Whether two neighbouring ratios differ too much for a curve through them.
fn is_far(one: Complex<f64>, other: Complex<f64>) -> bool {
    let largest = one.norm().max(other.norm());
    (one - other).norm() > MAX_CHANGE * largest
}

/// A hint for an unknown name: a similar one, or all names.
fn hint(name: &str, ports: &[Port], none: &str) -> String {
    let known: Vec<&str> = ports.iter().map(|port| port.name.as_str()).collect();
    suggestion(name, &known).unwrap_or_else(|| format!("the patch has {none}"))
}
