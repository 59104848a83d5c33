//! Read groups: the vertex properties `group` and `also`, and the element `group`.

use super::header::{Element, PropertyKind};
use super::values::{BodyValues, Event};
use crate::scene::groups::{Groups, MAX_GROUPS};

const GROUP: &str = "element vertex: property `group` must be one integer, the number of a group; \
                     if it is something else, rename it";
const ALSO: &str = "element vertex: property `also` must be a list of integers, further groups; if \
                    it is something else, rename it";

/// The meaning of a vertex property for groups.
#[derive(Clone, Copy)]
pub(super) enum GroupPart {
    /// The vertex's own group.
    Own,
    /// Further groups that the vertex was added to.
    Also,
}

/// Groups in the making.
pub(super) struct Reader {
    /// Whether vertices have groups; otherwise nothing is read.
    wanted: bool,
    /// Own groups of the vertices that are complete.
    own: Vec<u8>,
    added: Vec<(u32, u8)>,
    scale: Option<Vec<f32>>,
    /// The current vertex: its own group, and a bit for each group that it is in.
    current: u8,
    member: u64,
}

impl Reader {
    pub(super) fn new(vertex: &Element) -> Self {
        let wanted = vertex.properties.iter().any(|property| property.name == "group");
        let (own, added) = (Vec::new(), Vec::new());
        Self { wanted, own, added, scale: None, current: 0, member: 0 }
    }

    /// What a property of this name and kind says about groups, if anything.
    pub(super) fn part(&self, name: &str, kind: PropertyKind) -> Result<Option<GroupPart>, String> {
        match (name, kind) {
            _ if !self.wanted => Ok(None),
            ("group", PropertyKind::One(scalar)) if scalar.is_integer() => Ok(Some(GroupPart::Own)),
            ("group", _) => Err(GROUP.into()),
            ("also", PropertyKind::List { item, .. }) if item.is_integer() => {
                Ok(Some(GroupPart::Also))
            }
            ("also", _) => Err(ALSO.into()),
            _ => Ok(None),
        }
    }

    /// Takes a number of a property of the current vertex.
    pub(super) fn put(&mut self, part: GroupPart, value: f64) -> Result<(), String> {
        if !(value >= 0.0 && value < MAX_GROUPS as f64) {
            let last = MAX_GROUPS - 1;
            return Err(format!("group {value} does not exist; groups are 0 to {last}"));
        }
        let group = value as u8;
        if self.member >> group & 1 != 0 {
            return Err(format!("the vertex is in group {group} twice; keep one"));
        }
        self.member |= 1 << group;
        match part {
            GroupPart::Own => self.current = group,
            GroupPart::Also => self.added.push((self.own.len() as u32, group)),
        }
        Ok(())
    }

    /// Completes the current vertex.
    pub(super) fn end(&mut self) {
        if self.wanted {
            self.own.push(self.current);
            self.member = 0;
        }
    }

    /// Reads the element `group`.
    pub(super) fn scales(
        &mut self,
        element: &Element,
        values: &mut BodyValues<'_>,
    ) -> Result<(), String> {
        if !self.wanted {
            return values.walk(element, |_| Ok(()));
        }
        if element.count == 0 || element.count > MAX_GROUPS as u64 {
            let count = element.count;
            return Err(format!("element group has count {count}; groups are 1 to {MAX_GROUPS}"));
        }
        let scale = element.properties.iter().position(|property| property.name == "scale");
        let scale = scale.ok_or("element group has no property scale; declare it")?;
        if let PropertyKind::List { .. } = element.properties[scale].kind {
            return Err("element group: property `scale` is a list, but must be one number".into());
        }
        let mut found = Vec::new();
        values.walk(element, |event| {
            match event {
                Event::Value(property, value) if property == scale => {
                    let value = value as f32;
                    if !(value > 0.0 && value.is_finite()) {
                        return Err(format!("a scale of {value}; it must be finite and > 0"));
                    }
                    found.push(value);
                }
                Event::Value(..) | Event::End => {}
            }
            Ok(())
        })?;
        self.scale = Some(found);
        Ok(())
    }

    /// The groups, if there are any.
    pub(super) fn finish(self) -> Result<Option<Groups>, String> {
        if !self.wanted {
            return Ok(None);
        }
        let numbers = self.own.iter().chain(self.added.iter().map(|pair| &pair.1));
        let last = numbers.fold(0, |last, &group| last.max(group));
        let scale = self.scale.unwrap_or_else(|| vec![1.0; usize::from(last) + 1]);
        Groups::new(self.own, self.added, scale).map(Some).map_err(|error| error.to_string())
    }
}
