//! Finished points of sweeps, kept as they come and found again.

use crate::failure::Failure;
use actuator::{PointKey, PointStore, StoreError};
use serde::{Serialize, de::DeserializeOwned};
use std::{collections::HashSet, path::Path};

/// A store, and which of its points belong to the sweeps of this run.
pub struct Points {
    store: PointStore,
    own: HashSet<PointKey>,
    is_told: bool,
}

impl Points {
    /// The points in a directory, which is made where it is missing. What is damaged there is told, and computed again.
    pub fn open(directory: &Path) -> Result<Self, Failure> {
        let store = PointStore::open(directory).map_err(Failure::file)?;
        for warning in store.warnings() {
            eprintln!("warning: {warning}");
        }
        Ok(Points { store, own: HashSet::new(), is_told: false })
    }

    /// The directory.
    pub fn directory(&self) -> &Path {
        self.store.directory()
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.store.len()
    }

    /// Number of points that no sweep of this run has asked for or put there.
    pub fn strangers(&self) -> usize {
        self.store.len() - self.own.len()
    }

    /// The point of a key, if it was ever finished and is wanted. Wanted or not, it belongs to a sweep of this run.
    pub fn find<T: DeserializeOwned>(&mut self, key: PointKey, is_wanted: bool) -> Option<T> {
        self.own.extend(self.store.contains(&key).then_some(key));
        if is_wanted { self.store.get(&key) } else { None }
    }

    /// Keeps a point. If that cannot be, the sweep goes on, and says so once.
    pub fn keep<T: Serialize>(&mut self, key: Result<PointKey, StoreError>, point: &T) {
        let kept = key.and_then(|key| self.store.put(key, point).map(|()| self.own.insert(key)));
        if let Err(error) = kept
            && !std::mem::replace(&mut self.is_told, true)
        {
            eprintln!("warning: {error}; finished points are not stored, and a kill would lose them");
        }
    }

    /// Waits until all points outlast a loss of power.
    pub fn sync(&mut self) -> Result<(), Failure> {
        self.store.sync().map_err(Failure::file)
    }

    /// Removes the points, and their directory if nothing else is in it.
    pub fn remove(self) -> Result<(), Failure> {
        self.store.remove().map_err(Failure::file)
    }
}
