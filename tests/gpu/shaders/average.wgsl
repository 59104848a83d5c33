// From sums to averages.

fn average(sum: vec3<f32>, weight: f32) -> vec3<f32> {
    if weight > 0.0 || bug == NO_WEIGHT_GUARD {
        return sum / weight;
    }
    return vec3(0.0);
}

fn direction(sum: vec3<f32>, weight: f32) -> vec3<f32> {
    let mean = average(sum, weight);
    let length = sqrt(dot(mean, mean));
    if length > 0.0 || bug == NO_WEIGHT_GUARD {
        return mean / length;
    }
    return vec3(0.0);
}
