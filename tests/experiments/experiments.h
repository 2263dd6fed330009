#pragma once

// What can be run: pliant_experiments glob 6

namespace pliant::experiment {

void globExperiment( int orientations );
void vibrationExperiment();
void barExperiment();
void splitsExperiment();
void pullExperiment();

} // namespace pliant::experiment
