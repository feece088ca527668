use crate::point_key;
use actuator::{FreeMap, FreePath, LoadedFree, PointKey, StoreError};
use fe::{CappedSweep, CapsReport, FreeSweep, FreeSweepError, FreeSweepReport, Run, Shard, SolidSweep};

/// Told of each path that was found.
type Finished<'a> = dyn FnMut(&LoadedFree, &FreePath) + Send + 'a;

/// What was done; about caps, too, where sections are corrected for them.
type Report = (FreeSweepReport, Option<CapsReport>);

/// What computes the paths of a FREE's map.
pub trait PathSweep: Sync {
    /// What is counted while it does.
    const STEPS: &str;

    /// What the path of a node or check of a map is stored under.
    fn key(&self, map: &FreeMap, node: &LoadedFree) -> Result<PointKey, StoreError>;

    /// The FREEs of the checks.
    fn check_points(&self, map: &FreeMap) -> Vec<LoadedFree>;

    /// Computes the paths that are missing and belong to `shard`.
    fn fill(
        &self,
        map: &mut FreeMap,
        shard: Shard,
        run: &Run<'_>,
        finished: &mut Finished<'_>,
    ) -> Result<Report, FreeSweepError>;
}

impl PathSweep for FreeSweep {
    const STEPS: &str = "paths";

    fn key(&self, map: &FreeMap, node: &LoadedFree) -> Result<PointKey, StoreError> {
        point_key::section(self, node, &map.pressures)
    }

    fn check_points(&self, map: &FreeMap) -> Vec<LoadedFree> {
        self.check_points(map)
    }

    fn fill(
        &self,
        map: &mut FreeMap,
        shard: Shard,
        run: &Run<'_>,
        finished: &mut Finished<'_>,
    ) -> Result<Report, FreeSweepError> {
        Ok((self.fill(map, shard, run, finished)?, None))
    }
}

impl PathSweep for SolidSweep {
    const STEPS: &str = "states";

    fn key(&self, map: &FreeMap, node: &LoadedFree) -> Result<PointKey, StoreError> {
        point_key::solid(self, node, &map.pressures)
    }

    fn check_points(&self, map: &FreeMap) -> Vec<LoadedFree> {
        self.check_points(map)
    }

    fn fill(
        &self,
        map: &mut FreeMap,
        shard: Shard,
        run: &Run<'_>,
        finished: &mut Finished<'_>,
    ) -> Result<Report, FreeSweepError> {
        Ok((self.fill(map, shard, run, finished)?, None))
    }
}

impl PathSweep for CappedSweep {
    const STEPS: &str = "states of solids";

    fn key(&self, map: &FreeMap, node: &LoadedFree) -> Result<PointKey, StoreError> {
        let is_check = self.check_points(map).contains(node);
        point_key::capped(self, (node, is_check), map.shear_moduli(), &map.pressures)
    }

    fn check_points(&self, map: &FreeMap) -> Vec<LoadedFree> {
        self.check_points(map)
    }

    fn fill(
        &self,
        map: &mut FreeMap,
        shard: Shard,
        run: &Run<'_>,
        finished: &mut Finished<'_>,
    ) -> Result<Report, FreeSweepError> {
        let (report, caps) = self.fill(map, shard, run, finished)?;
        Ok((report, Some(caps)))
    }
}
