//! How far a search has come.

/// What a search is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The patch as it is is fitted.
    Base,
    /// Every effect is looked at quickly, at every place.
    Quick,
    /// The best of them are gone through with.
    Full,
    /// The best are fitted to ever more of the records.
    Growing,
    /// Forces are looked for at every junction.
    Where,
}

/// Where a search stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Which effect is looked for, from 1 on; 0 outside rounds.
    pub round: usize,
    /// What is being done.
    pub part: Part,
    /// How many trials of this part are done,
    pub done: u64,
    /// and of how many; 0 where they are not counted.
    pub all: u64,
}

impl Progress {
    /// The beginning of a part that is not counted.
    pub(crate) fn of(part: Part) -> Progress {
        Progress { round: 0, part, done: 0, all: 0 }
    }
}
