#pragma once

// Experiments that pliant_experiments runs, for example: pliant_experiments glob 6

namespace pliant::experiment {

void globExperiment( int orientations );
void vibrationExperiment();
void barExperiment();
void splitsExperiment();
void pullExperiment();
void dropsExperiment( int count );
void shotsExperiment( int count );
void impactsExperiment( int count );
void shattersExperiment( int count );
/// Writes crack.png and crack_near.png into the working directory.
void crackExperiment();
void raysExperiment( int count );
void slidesExperiment();
void thingsExperiment( int count );
void refineExperiment();
void bunnyExperiment();
void nodeExperiment();

} // namespace pliant::experiment
