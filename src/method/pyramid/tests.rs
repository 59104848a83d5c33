//! Stages, planes and explanations of the pyramid.
