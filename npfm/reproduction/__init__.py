"""Does a run reproduce Bagher et al. 2016? Its claims as data, put to the run's tables."""
