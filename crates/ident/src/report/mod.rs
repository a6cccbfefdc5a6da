//! Reports of a search: sentences, the JSON document, the page, and the patches that it leaves.

pub mod document;
pub(crate) mod doubts;
pub mod effect_page;
pub mod page;
pub(crate) mod provenance;
pub(crate) mod ranges;
pub(crate) mod reasons;
pub(crate) mod rounds;
pub(crate) mod sentence;
pub(crate) mod values;
