//! What was worked out for a scene, and is kept for the next render of it.

use std::{
    any::Any,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

/// The last result and its key: a render begins with what its pilot chose.
#[derive(Debug, Default)]
pub struct Memo(Mutex<Known>);

type Known = Option<(String, Arc<dyn Any + Send + Sync>)>;

/// What a memo kept at some time; by default nothing.
#[derive(Clone, Debug, Default)]
pub struct Kept(Known);

impl Clone for Memo {
    /// Forgets: the scene may be changed.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Memo {
    /// What there is for `key`.
    pub fn known<T: Clone + Send + Sync + 'static>(&self, key: &str) -> Option<T> {
        match &*self.lock() {
            Some((known, learnt)) if known == key => learnt.downcast_ref().cloned(),
            _ => None,
        }
    }

    /// What is kept for `key`, or else what `learn` finds.
    pub fn recall<T: Clone + Send + Sync + 'static>(&self, key: String, learn: impl FnOnce() -> T) -> T {
        // Learns without the lock: threads that learn may take up other work, which asks for the same key.
        self.known(&key).unwrap_or_else(|| {
            let learnt = learn();
            self.keep(key, learnt.clone());
            learnt
        })
    }

    /// From now on, `learnt` is what there is for `key`.
    pub fn keep<T: Send + Sync + 'static>(&self, key: String, learnt: T) {
        *self.lock() = Some((key, Arc::new(learnt)));
    }

    /// What is kept now, to be [put back](Self::put_back).
    pub fn kept(&self) -> Kept {
        Kept(self.lock().clone())
    }

    /// Forgets all but what was `kept` then.
    pub fn put_back(&self, kept: &Kept) {
        *self.lock() = kept.0.clone();
    }

    fn lock(&self) -> MutexGuard<'_, Known> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
