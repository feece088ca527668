//! How the work on a map outlasts the run: what earlier ones have left is taken up, and nothing that took time is lost.

use crate::{
    failure::Failure,
    interrupt,
    map_file::MapFile,
    plan::Plan,
    points::Points,
    sweep::{Sweeping, Swept},
};
use fe::Shard;
use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

/// Where a map and its points are kept.
pub struct Lasting<'a> {
    /// The map.
    pub out: &'a Path,
    /// The store that was named; without one, there is one beside the map until that is complete.
    pub store: Option<&'a Path>,
    /// Whether to go on from what is there.
    pub resume: bool,
}

impl Lasting<'_> {
    /// Completes a map and writes it.
    pub fn complete(&self, plan: Plan, shard: Shard, jobs: usize) -> Result<(MapFile, Swept), Failure> {
        let directory = match self.store {
            Some(store) => store.to_owned(),
            None => beside(self.out),
        };
        if self.resume && self.store.is_none() && !self.out.exists() && !directory.exists() {
            return Err(Failure::refused(format!(
                "{}: there is no map to resume; leave out --resume to begin one",
                self.out.display()
            )));
        }
        let completed = self.complete_with(Points::open(&directory)?, plan, shard, jobs);
        if self.store.is_none() {
            // Goes only if it is empty.
            drop(fs::remove_dir(&directory));
        }
        completed
    }

    fn complete_with(
        &self,
        points: Points,
        mut plan: Plan,
        shard: Shard,
        jobs: usize,
    ) -> Result<(MapFile, Swept), Failure> {
        let points = Mutex::new(points);
        let sweeping = Sweeping { shard, jobs, points: Some(&points) };
        let unfinished = self.take_up_map(&mut plan)?;
        plan.recall(&sweeping)?;
        let (computed, nodes) = plan.map().computed();
        if unfinished > computed {
            return Err(Failure::refused(format!(
                "{} holds {unfinished} of {nodes} nodes of this sweep; give --resume to complete it, or remove it",
                self.out.display()
            )));
        }
        self.judge(&points.lock().unwrap_or_else(PoisonError::into_inner))?;

        let (map, swept) = plan.complete(&sweeping)?;
        map.write(self.out)?;
        let mut points = points.into_inner().unwrap_or_else(PoisonError::into_inner);
        if self.store.is_some() || interrupt::is_asked() {
            points.sync()?;
        } else if points.strangers() > 0 {
            let (strangers, directory) = (points.strangers(), points.directory().display());
            eprintln!("{directory} is left there: {strangers} of its points are not of this map");
        } else {
            points.remove()?;
        }
        Ok((map, swept))
    }

    /// Takes over what --out holds, if it is to be resumed. Otherwise gives how many nodes of this very sweep it holds, if they
    /// are not all: that may be hours of work, and anything else is replaced, as everywhere.
    fn take_up_map(&self, plan: &mut Plan) -> Result<usize, Failure> {
        if !self.out.exists() {
            return Ok(0);
        }
        let earlier = match MapFile::read(self.out) {
            Err(_) if !self.resume => return Ok(0),
            earlier => earlier?,
        };
        let difference = plan.map().difference(&earlier);
        if self.resume {
            return match difference {
                None => plan.absorb(earlier).map(|()| 0),
                Some(what) => Err(Failure::refused(format!(
                    "{} is a map of another sweep: {what} differ; give the settings it was begun with, or another --out",
                    self.out.display()
                ))),
            };
        }
        let (computed, nodes) = earlier.computed();
        Ok(if difference.is_none() && computed < nodes { computed } else { 0 })
    }

    /// Whether the points beside the map may be taken, and removed in the end.
    fn judge(&self, points: &Points) -> Result<(), Failure> {
        if self.store.is_some() || points.len() == 0 {
            return Ok(());
        }
        let (directory, own) = (points.directory().display(), points.len() - points.strangers());
        match own {
            0 => Err(Failure::refused(format!(
                "{directory} holds {} finished points of another sweep, or of another version of freeact; give --resume and the \
                 settings it was begun with, or another --out, or remove the folder",
                points.len()
            ))),
            _ if !self.resume => Err(Failure::refused(format!(
                "{directory} holds {own} finished points of this sweep; give --resume to go on from them, or remove the folder"
            ))),
            _ => Ok(()),
        }
    }
}

/// The folder of a map's points, where none is named.
pub fn beside(map: &Path) -> PathBuf {
    let mut name = map.as_os_str().to_owned();
    name.push(".points");
    name.into()
}
