#pragma once

// Constants of the loops over tasks, each with its unit and reason.

namespace pliant {

/// Maximum number of chunks of a range. Sums over each chunk, added in the order of chunks, are the same for any number of threads.
inline constexpr int kMaxChunks = 16;
/// Minimum chunk size, elements: some microseconds of work, comparable to the cost of starting a task.
inline constexpr int kMinChunkSize = 1024;

/// Maximum number of threads of a pool; it has no more if more are asked for.
inline constexpr int kMaxThreads = 64;
/// Time that a thread spins for work, or for the end of a run, before it sleeps, microseconds: about the cost of waking up. The stages of a
/// step follow one another faster than this.
inline constexpr int kSpinTime = 20;
/// Number of checks for work between two reads of the clock, each of which costs as much as several checks.
inline constexpr int kChecksPerClockRead = 64;

} // namespace pliant
