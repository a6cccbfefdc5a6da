//! The kernels of a program, folded once for every stance, whatever the number of machines that run it.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::rows::Columns;
use super::{Asked, Backend, Formation, Frame, Kernel, Look, Native, Stance, Steps};
use crate::ir::{Program, Register};

/// Kernels that all copies of a program share.
#[derive(Default)]
pub(crate) struct Kernels(Mutex<Vec<Arc<Folded>>>);

/// A kernel, for what it was folded, and its native code once that pays.
#[derive(Debug)]
pub(crate) struct Folded {
    modes: Vec<f64>,
    asked: Vec<Asked>,
    seen: Vec<Register>,
    pub kernel: Kernel,
    /// Whether all that is recorded follows states.
    records_states: bool,
    /// Where everything stands in the rows of native code.
    columns: Columns,
    native: OnceLock<Option<Native>>,
    /// So many steps and looks are interpreted before native code is made.
    pays: u64,
    /// Steps and looks that were interpreted.
    interpreted: AtomicU64,
}

/// So many kernels are kept, those that were asked for last.
const MOST_KERNELS: usize = 64;
/// From so many frames on their steps are interpreted together as quickly as each is alone (docs/performance.md), ...
pub(crate) const FEWEST_ABREAST: usize = 3;
/// ... and from so many as quickly as native code takes them one after the other.
pub(super) const FEWEST_BEYOND_NATIVE: usize = 10;
/// After so many interpreted steps native code has been worth its making, had it been there from the beginning: so many in
/// any case, ...
const PAYS: u64 = 6_000;
/// ... and so many more for each of its operations. It takes the longer to make, and gains the less a step, the more it has.
const PAYS_AN_OPERATION: u64 = 16;

/// After how many interpreted steps native code of a kernel is made.
pub(super) fn pays(kernel: &Kernel) -> u64 {
    PAYS + PAYS_AN_OPERATION * kernel.operations() as u64
}

impl Kernels {
    /// The kernel of a program in a stance that gives these registers; `None` if the program has none.
    pub fn of(program: &Program, stance: Stance<'_>, seen: &[Register]) -> Option<Arc<Folded>> {
        program.cache.get::<Kernels>().find_or_fold(program, stance, seen)
    }

    fn find_or_fold(&self, program: &Program, stance: Stance<'_>, seen: &[Register]) -> Option<Arc<Folded>> {
        // Whoever broke off left the list as whole as it was.
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = all.iter().position(|known| known.is_for(stance) && known.seen == seen) {
            // What was asked for last stands last.
            all[known..].rotate_left(1);
            return all.last().cloned();
        }
        let kernel = Kernel::new(program, stance, seen)?;
        let folded = Arc::new(Folded {
            modes: stance.modes.to_vec(),
            asked: stance.asked.to_vec(),
            seen: seen.to_vec(),
            native: OnceLock::new(),
            pays: pays(&kernel),
            records_states: kernel.records_states(),
            columns: Columns::of(&kernel),
            kernel,
            interpreted: AtomicU64::new(0),
        });
        if all.len() == MOST_KERNELS {
            all.remove(0);
        }
        all.push(Arc::clone(&folded));
        Some(folded)
    }
}

impl Folded {
    /// Whether it was folded for this stance.
    pub fn is_for(&self, stance: Stance<'_>) -> bool {
        self.modes == stance.modes && self.asked == stance.asked
    }

    /// A frame without numbers, with room for what a backend needs.
    pub fn frame(&self, backend: Backend) -> Frame<f64> {
        let frame = self.kernel.frame();
        if backend.may_be_native() { frame.with_rows(&self.columns) } else { frame }
    }

    /// Goes so many steps of a grid from one of its instants, as long as nothing is met: how many were gone.
    pub fn steps(
        &self,
        frame: &mut Frame<f64>,
        tables: &[Vec<[f64; 2]>],
        steps: &Steps,
        backend: Backend,
    ) -> u64 {
        if let Some(native) = self.native(backend) {
            return native.steps(frame, tables, steps);
        }
        let gone = self.kernel.steps(frame, tables, steps);
        self.count(gone, backend);
        gone
    }

    /// The same of several frames, as long as nothing is met in any. There is no native code of that.
    pub fn steps_abreast(
        &self,
        formation: &mut Formation,
        tables: &[Vec<[f64; 2]>],
        steps: &Steps,
        backend: Backend,
    ) -> u64 {
        let lanes = u64::from(formation.aboard().count_ones());
        let gone = self.kernel.steps(&mut formation.frame, tables, steps);
        self.count(lanes * gone, backend);
        gone
    }

    /// From how many frames on their steps are quicker taken together than by one after the other.
    pub fn fewest_abreast(&self, backend: Backend) -> usize {
        if self.native(backend).is_some() { FEWEST_BEYOND_NATIVE } else { FEWEST_ABREAST }
    }

    /// Whether what is recorded is remembered of every step, where that is asked for: of states, by native code.
    pub fn remembers(&self, backend: Backend) -> bool {
        self.records_states && self.native(backend).is_some()
    }

    /// Counts what native code, where it may still be made, would have been quicker at.
    fn count(&self, interpreted: u64, backend: Backend) {
        if backend == Backend::Automatic && self.native.get().is_none() {
            self.interpreted.fetch_add(interpreted, Ordering::Relaxed);
        }
    }

    /// Looks ahead by a step of this length.
    pub fn look(
        &self,
        frame: &mut Frame<f64>,
        tables: &[Vec<[f64; 2]>],
        length: f64,
        backend: Backend,
    ) -> Look {
        if let Some(native) = self.native(backend) {
            return native.look(frame, tables, length);
        }
        self.count(1, backend);
        self.kernel.look_ahead(frame, tables, length)
    }

    /// Works everything out at the states and the time in the slots.
    pub fn work_out(&self, frame: &mut Frame<f64>, tables: &[Vec<[f64; 2]>], backend: Backend) {
        match self.native(backend) {
            Some(native) => native.work_out(frame, tables),
            None => self.kernel.work_out(frame, tables),
        }
    }

    fn native(&self, backend: Backend) -> Option<&Native> {
        let wanted = match backend {
            Backend::Native => true,
            Backend::Automatic => self.interpreted.load(Ordering::Relaxed) >= self.pays,
            _ => false,
        };
        wanted.then(|| self.native.get_or_init(|| Native::new(&self.kernel)).as_ref()).flatten()
    }
}
