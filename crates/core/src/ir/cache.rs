//! A place where a backend keeps what it has derived from a program, for all copies of the program.

use std::any::Any;
use std::fmt;
use std::sync::{Arc, OnceLock};

/// At most one value, of a type that only the backend knows.
#[derive(Default)]
pub(crate) struct Cache(OnceLock<Arc<dyn Any + Send + Sync>>);

impl Cache {
    /// The value, made when it is first asked for. A second type finds no place and gets a value of its own.
    pub fn get<T: Default + Send + Sync + 'static>(&self) -> Arc<T> {
        let value = self.0.get_or_init(|| Arc::new(T::default()));
        Arc::clone(value).downcast().unwrap_or_default()
    }
}

impl Clone for Cache {
    /// A program that is copied to be changed derives everything again.
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
