//! Sort records that do not fit into memory: runs on disk, then one merge.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Bytes of a key before its record.
const KEY: usize = 8;

/// Records of one size, in the order in which they come; each has a key.
pub(super) struct Sorter {
    file: File,
    /// Bytes of a record, with its key.
    size: usize,
    /// How many bytes all runs may hold in memory.
    budget: usize,
    /// The records of the current run, and for each its key and its place.
    records: Vec<u8>,
    keys: Vec<(u64, u32)>,
    /// How many records each run has.
    runs: Vec<u64>,
}

impl Sorter {
    /// Sorts records of `size` bytes in a temporary file in `folder`.
    pub(super) fn new(folder: &Path, size: usize, budget: usize) -> io::Result<Self> {
        let file = tempfile::tempfile_in(folder)?;
        let (records, keys, runs) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { file, size: KEY + size, budget, records, keys, runs })
    }

    /// Adds a record, which `put` appends. Records with equal keys keep their order.
    pub(super) fn push(&mut self, key: u64, put: impl FnOnce(&mut Vec<u8>)) -> io::Result<()> {
        // A record in memory, its place, and the buffer that is written.
        let most = (self.budget / (self.size + size_of::<(u64, u32)>())).max(1);
        if self.keys.is_empty() {
            self.records.reserve_exact(most * self.size);
            self.keys.reserve_exact(most);
        }
        self.keys.push((key, self.keys.len() as u32));
        self.records.extend(key.to_le_bytes());
        put(&mut self.records);
        if self.keys.len() == most { self.end_run() } else { Ok(()) }
    }

    /// Writes the records in memory as a run.
    fn end_run(&mut self) -> io::Result<()> {
        self.keys.sort_unstable();
        let mut to = BufWriter::new(&mut self.file);
        for (_, place) in &self.keys {
            to.write_all(&self.records[*place as usize * self.size..][..self.size])?;
        }
        to.flush()?;
        self.runs.push(self.keys.len() as u64);
        self.records.clear();
        self.keys.clear();
        Ok(())
    }

    /// Calls `visit` with each record, without its key, in ascending order of the keys.
    pub(super) fn finish(
        mut self,
        mut visit: impl FnMut(&[u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        if !self.keys.is_empty() {
            self.end_run()?;
        }
        // Free the memory of the runs for the merge.
        (self.records, self.keys) = (Vec::new(), Vec::new());
        let Self { mut file, size, budget, runs, .. } = self;
        let room = (budget / runs.len().max(1) / size).max(1);
        let mut first = 0;
        let mut runs: Vec<Run> = runs
            .iter()
            .map(|&left| {
                let run = Run { at: first, left, chunk: Vec::new(), used: 0 };
                first += left * size as u64;
                run
            })
            .collect();
        // Equal keys are taken from the first run, because runs are in the order of the records.
        let mut heap = BinaryHeap::new();
        for (number, run) in runs.iter_mut().enumerate() {
            heap.extend(run.key(&mut file, size, room)?.map(|key| Reverse((key, number))));
        }
        while let Some(Reverse((_, number))) = heap.pop() {
            let run = &mut runs[number];
            visit(&run.chunk[run.used + KEY..][..size - KEY])?;
            run.used += size;
            heap.extend(run.key(&mut file, size, room)?.map(|key| Reverse((key, number))));
        }
        Ok(())
    }
}

/// A run that is read from its beginning.
struct Run {
    /// Where the rest begins in the file.
    at: u64,
    /// How many records are left there.
    left: u64,
    /// Records in memory, of which so many bytes are used up.
    chunk: Vec<u8>,
    used: usize,
}

impl Run {
    /// The key of the next record, which is then in memory; `None` at the end.
    fn key(&mut self, file: &mut File, size: usize, room: usize) -> io::Result<Option<u64>> {
        if self.used == self.chunk.len() {
            let count = self.left.min(room as u64);
            self.chunk.resize(count as usize * size, 0);
            file.seek(SeekFrom::Start(self.at))?;
            file.read_exact(&mut self.chunk)?;
            (self.at, self.left) = (self.at + self.chunk.len() as u64, self.left - count);
            self.used = 0;
        }
        Ok(self.chunk[self.used..].first_chunk().copied().map(u64::from_le_bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::random::below;
    use tempfile::TempDir;

    #[test]
    fn records_come_in_the_order_of_a_stable_sort() {
        let at = TempDir::new().unwrap();
        // One run, one record a run, and runs of several records.
        for (count, budget) in [(0, 1000), (1, 1), (97, 1), (500, 700), (500, 1 << 20)] {
            let records: Vec<(u64, u32)> =
                (0..count).map(|i| (below(7, i.into(), 40), i)).collect();
            let mut sorter = Sorter::new(at.path(), 4, budget).unwrap();
            for (key, record) in &records {
                sorter.push(*key, |to| to.extend(record.to_le_bytes())).unwrap();
            }
            let mut found = Vec::new();
            sorter
                .finish(|record| {
                    found.push(u32::from_le_bytes(record.try_into().unwrap()));
                    Ok(())
                })
                .unwrap();
            let mut expected = records;
            expected.sort_by_key(|(key, _)| *key);
            assert_eq!(found, expected.iter().map(|(_, i)| *i).collect::<Vec<_>>());
        }
        assert_eq!(std::fs::read_dir(at.path()).unwrap().count(), 0);
    }
}
