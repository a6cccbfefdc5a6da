//! A place in which a backend stores data that it has derived from a program.
//!
//! All copies of a program share it, so a kernel is compiled once, however many runs use it.

use std::any::Any;
use std::fmt;
use std::sync::{Arc, OnceLock};

/// At most one value, of a type that only the backend names.
#[derive(Default)]
pub(crate) struct Cache(OnceLock<Arc<dyn Any + Send + Sync>>);

impl Cache {
    /// The value, created at the first call. A call with a second type returns a new value that is not stored.
    pub(crate) fn get<T: Default + Send + Sync + 'static>(&self) -> Arc<T> {
        let value = self.0.get_or_init(|| Arc::new(T::default()));
        Arc::clone(value).downcast().unwrap_or_default()
    }
}

impl Clone for Cache {
    /// A clone is made only to be changed, so everything must be derived again.
    fn clone(&self) -> Self {
        Cache::default()
    }
}

impl fmt::Debug for Cache {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Cache")
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    #[test]
    fn the_value_is_shared_and_a_copy_begins_empty() {
        let cache = Cache::default();
        *cache.get::<Mutex<u32>>().lock().unwrap() = 7;
        assert_eq!(*cache.get::<Mutex<u32>>().lock().unwrap(), 7);
        assert_eq!(*cache.clone().get::<Mutex<u32>>().lock().unwrap(), 0);
        assert_eq!(cache.get::<String>().as_str(), "");
    }
}
