//! Stages, planes and explanations of the templates.
