// The operations that a promise speaks of, one result each.

struct Numbers {
    a: f32, b: f32, // from 2^-10 to 2^10
    x: f32, // from -2 to 0, as in a weight
    product: f32, // a b, correctly rounded
    large: f32, // so large that large + a rounds to large
    normal: f32, denormal: f32, // a normal number below 2^-125, a denormal one
    spare: f32,
}

struct Results {
    exponential: f32, quotient: f32, root: f32, product: f32,
    sum: f32, residue: f32, regrouped: f32, written: f32,
    read: f32, spare: vec3<f32>,
}

@group(0) @binding(0) var<storage, read> numbers: array<Numbers>;
@group(0) @binding(1) var<storage, read_write> results: array<Results>;

@compute @workgroup_size(64)
fn operate(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&numbers) {
        return;
    }
    let n = numbers[id.x];
    var r = Results();
    r.exponential = exp(n.x);
    r.quotient = n.a / n.b;
    r.root = sqrt(n.a);
    r.product = n.a * n.b;
    r.sum = n.a + n.b;
    r.residue = n.a * n.b - n.product; // 0 unless fused
    r.regrouped = (n.large + n.a) - n.large; // 0 in the written order
    r.written = n.normal * 0.25; // 0 if denormal results are flushed
    r.read = n.denormal * 1024.0; // 0 if denormal operands are
    results[id.x] = r;
}
