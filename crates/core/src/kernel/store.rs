//! The cache of kernels: each specialisation of a program is built once, however many machines run the program.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::rows::RowLayout;
use super::{AmplifierState, Backend, Frame, Kernel, LaneFrame, LookResult, Native, Specialisation, Steps};
use crate::ir::{Program, Register};

/// The kernels of a program, shared by all its copies.
#[derive(Default)]
pub(crate) struct Kernels(Mutex<Vec<Arc<SharedKernel>>>);

/// A kernel, what it was specialised to, and its native code once that is worth compiling.
#[derive(Debug)]
pub(crate) struct SharedKernel {
    /// The modes of the specialisation.
    modes: Vec<f64>,
    /// The amplifier states of the specialisation.
    amplifiers: Vec<AmplifierState>,
    /// Registers of the recorded voltages.
    recorded: Vec<Register>,
    /// The kernel itself.
    pub kernel: Kernel,
    /// Whether every recorded voltage tracks a state.
    is_tracking_states_only: bool,
    /// The arrangement of the rows that native code writes.
    columns: RowLayout,
    /// Native code, once it has been requested; the inner value is `None` if it is impossible.
    native: OnceLock<Option<Native>>,
    /// Number of interpreted steps and look-aheads after which native code is compiled.
    native_threshold: u64,
    /// Number of steps and look-aheads that were interpreted so far.
    interpreted: AtomicU64,
}

/// Maximum number of cached kernels. The one that was not used for the longest time is dropped.
const MAX_KERNELS: usize = 64;
/// Number of runs from which interpreting them in lanes is as fast as interpreting them one by one. The measurements
/// are in docs/performance.md.
pub(crate) const MIN_LANES: usize = 3;
/// Number of runs from which interpreting them in lanes is as fast as native code for one after the other.
pub(super) const MIN_LANES_OVER_NATIVE: usize = 10;
/// Constant part of the number of interpreted steps after which native code is compiled. After that many steps, native
/// code from the beginning would have been as fast.
const NATIVE_THRESHOLD: u64 = 6_000;
/// Number of interpreted steps per operation that are added to the constant part. A larger kernel takes longer to
/// compile and gains less per step.
const NATIVE_THRESHOLD_PER_OPERATION: u64 = 16;

/// Number of interpreted steps after which native code of a kernel is compiled.
pub(super) fn native_threshold(kernel: &Kernel) -> u64 {
    NATIVE_THRESHOLD + NATIVE_THRESHOLD_PER_OPERATION * kernel.operations() as u64
}

impl Kernels {
    /// The kernel of a program, specialised, that computes these registers. `None` if the program has no kernels.
    pub(crate) fn of(
        program: &Program,
        specialisation: Specialisation<'_>,
        recorded: &[Register],
    ) -> Option<Arc<SharedKernel>> {
        program.lowered.cache.get::<Kernels>().find_or_insert(program, specialisation, recorded)
    }

    /// The kernel with this specialisation and these registers. It is built if it is not cached. The lock is held
    /// meanwhile, so no kernel is built twice.
    fn find_or_insert(
        &self,
        program: &Program,
        specialisation: Specialisation<'_>,
        recorded: &[Register],
    ) -> Option<Arc<SharedKernel>> {
        // A panic elsewhere cannot leave the list incomplete, so a poisoned lock is safe to use.
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) =
            all.iter().position(|known| known.is_for(specialisation) && known.recorded == recorded)
        {
            // The kernel that was used last is at the end.
            all[known..].rotate_left(1);
            return all.last().cloned();
        }
        let kernel = Kernel::new(program, specialisation, recorded)?;
        let specialised = Arc::new(SharedKernel {
            modes: specialisation.modes.to_vec(),
            amplifiers: specialisation.amplifiers.to_vec(),
            recorded: recorded.to_vec(),
            native: OnceLock::new(),
            native_threshold: native_threshold(&kernel),
            is_tracking_states_only: kernel.is_tracking_states_only(),
            columns: RowLayout::of(&kernel),
            kernel,
            interpreted: AtomicU64::new(0),
        });
        if all.len() == MAX_KERNELS {
            all.remove(0);
        }
        all.push(Arc::clone(&specialised));
        Some(specialised)
    }
}

impl SharedKernel {
    /// Whether the kernel has this specialisation.
    pub(crate) fn is_for(&self, specialisation: Specialisation<'_>) -> bool {
        self.modes == specialisation.modes && self.amplifiers == specialisation.amplifiers
    }

    /// A frame for this kernel with the buffers that a backend needs. Its values are not set.
    pub(crate) fn frame(&self, backend: Backend) -> Frame<f64> {
        let frame = self.kernel.frame();
        if backend.can_be_native() { frame.with_rows(&self.columns) } else { frame }
    }

    /// Takes steps of a grid until a watch is hit. Returns how many steps were taken.
    pub(crate) fn steps(
        &self,
        frame: &mut Frame<f64>,
        tables: &[Vec<[f64; 2]>],
        steps: &Steps,
        backend: Backend,
    ) -> u64 {
        if let Some(native) = self.native(backend) {
            return native.steps(frame, tables, steps);
        }
        let taken = self.kernel.steps(frame, tables, steps);
        self.count(taken, backend);
        taken
    }

    /// Takes steps of several frames until a watch is hit in any of them. There is no native code for lanes.
    pub(crate) fn steps_in_lanes(
        &self,
        lane_frame: &mut LaneFrame,
        tables: &[Vec<[f64; 2]>],
        steps: &Steps,
        backend: Backend,
    ) -> u64 {
        let lanes = u64::from(lane_frame.active_lanes().count_ones());
        let taken = self.kernel.steps(&mut lane_frame.frame, tables, steps);
        self.count(lanes * taken, backend);
        taken
    }

    /// Number of frames from which their steps are faster in lanes than one after the other.
    pub(crate) fn min_lanes(&self, backend: Backend) -> usize {
        if self.native(backend).is_some() { MIN_LANES_OVER_NATIVE } else { MIN_LANES }
    }

    /// Whether the recorded voltages can be stored for every step. Only native code does this, and only for states.
    pub(crate) fn can_keep_trail(&self, backend: Backend) -> bool {
        self.is_tracking_states_only && self.native(backend).is_some()
    }

    /// Counts interpreted steps, as long as native code is not compiled yet.
    fn count(&self, interpreted: u64, backend: Backend) {
        if backend == Backend::Automatic && self.native.get().is_none() {
            self.interpreted.fetch_add(interpreted, Ordering::Relaxed);
        }
    }

    /// Evaluates a step of this length, without taking it, and tests every watch.
    pub(crate) fn look(
        &self,
        frame: &mut Frame<f64>,
        tables: &[Vec<[f64; 2]>],
        length: f64,
        backend: Backend,
    ) -> LookResult {
        if let Some(native) = self.native(backend) {
            let is_hit_at_end = native.look(frame, tables, length);
            return self.kernel.look_result(frame, is_hit_at_end);
        }
        self.count(1, backend);
        self.kernel.look_ahead(frame, tables, length)
    }

    /// Evaluates everything at the states and the time in the slots.
    pub(crate) fn evaluate(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], backend: Backend) {
        match self.native(backend) {
            Some(native) => native.evaluate(frame, tables),
            None => self.kernel.evaluate(frame, tables),
        }
    }

    /// The native code, if the backend uses it now. It is compiled at the first request.
    fn native(&self, backend: Backend) -> Option<&Native> {
        let wanted = match backend {
            Backend::Native => true,
            Backend::Automatic => self.interpreted.load(Ordering::Relaxed) >= self.native_threshold,
            _ => false,
        };
        wanted.then(|| self.native.get_or_init(|| Native::new(&self.kernel)).as_ref()).flatten()
    }
}
