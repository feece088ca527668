//! A table of a TOML file whose fields remember their line, for errors that point at it.

use crate::DescriptionError;
use std::{cell::RefCell, collections::BTreeSet, path::Path};
use toml::{Spanned, de::DeTable, de::DeValue};

/// What is wrong with a field, at which byte of the text.
pub(crate) struct FieldError {
    pub at: usize,
    pub field: String,
    pub message: String,
}

impl FieldError {
    pub fn in_file(self, path: &Path, text: &str) -> DescriptionError {
        let at = self.at.min(text.len());
        let line = text.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count() + 1;
        DescriptionError::Invalid { path: path.to_owned(), line, field: self.field, message: self.message }
    }
}

/// A table, the table of defaults behind it, and which of its fields were asked for.
pub(crate) struct Section<'t> {
    own: &'t DeTable<'t>,
    defaults: Option<&'t DeTable<'t>>,
    at: usize,
    prefix: String,
    asked: RefCell<BTreeSet<String>>,
}

/// Fields of a FREE, which may stand in `[defaults]` even where every FREE overrides them.
const FREE_FIELDS: [&str; 10] = [
    "length_mm",
    "inner_diameter_mm",
    "wall_mm",
    "winding_angle_deg",
    "handedness",
    "fibres",
    "fibre_ea_newton",
    "fibre_diameter_mm",
    "fibre_law",
    "elastomer",
];

type Checked<T> = Result<T, FieldError>;

impl<'t> Section<'t> {
    pub fn new(own: &'t DeTable<'t>, at: usize, prefix: &str) -> Self {
        Section { own, defaults: None, at, prefix: prefix.to_owned(), asked: RefCell::default() }
    }

    /// Fields missing here are looked up in `defaults`.
    pub fn fall_back_on(&mut self, defaults: Option<&Section<'t>>) {
        self.defaults = defaults.map(|section| section.own);
    }

    pub fn mark_free_fields(&self) {
        self.asked.borrow_mut().extend(FREE_FIELDS.map(str::to_owned));
    }

    fn name(&self, field: &str) -> String {
        format!("{}{field}", self.prefix)
    }

    fn find(&self, field: &str) -> Option<&'t Spanned<DeValue<'t>>> {
        self.asked.borrow_mut().insert(field.to_owned());
        self.own.get(field).or_else(|| self.defaults.and_then(|table| table.get(field)))
    }

    /// An error about a field, at its line, or at the table's where the field is missing.
    pub fn error(&self, field: &str, message: String) -> FieldError {
        let at = self.find(field).map_or(self.at, |value| value.span().start);
        FieldError { at, field: self.name(field), message }
    }

    fn missing(&self, field: &str, remedy: &str) -> FieldError {
        FieldError { at: self.at, field: self.name(field), message: format!("is missing; {remedy}") }
    }

    fn as_number(&self, field: &str, value: &Spanned<DeValue>) -> Checked<f64> {
        let text = match value.get_ref() {
            DeValue::Float(number) => number.as_str().replace('_', ""),
            DeValue::Integer(number) => number.as_str().replace('_', ""),
            other => {
                let message = format!("must be a number, not a {}", other.type_str());
                return Err(FieldError { at: value.span().start, field: self.name(field), message });
            }
        };
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(FieldError {
                at: value.span().start,
                field: self.name(field),
                message: format!("must be a finite decimal number, got {text}"),
            }),
        }
    }

    pub fn number(&self, field: &str, check: fn(f64) -> Result<(), &'static str>) -> Checked<Option<f64>> {
        let Some(value) = self.find(field) else { return Ok(None) };
        let number = self.as_number(field, value)?;
        check(number).map_err(|rule| self.error(field, format!("{rule}, got {number}")))?;
        Ok(Some(number))
    }

    pub fn required_number(&self, field: &str, check: fn(f64) -> Result<(), &'static str>) -> Checked<f64> {
        self.number(field, check)?.ok_or_else(|| self.missing(field, &format!("write {field} = a number")))
    }

    pub fn word(&self, field: &str) -> Checked<Option<String>> {
        match self.find(field).map(Spanned::get_ref) {
            None => Ok(None),
            Some(DeValue::String(word)) => Ok(Some(word.to_string())),
            Some(other) => {
                Err(self.error(field, format!("must be a word in quotes, not a {}", other.type_str())))
            }
        }
    }

    pub fn required_word(&self, field: &str, remedy: &str) -> Checked<String> {
        self.word(field)?.ok_or_else(|| self.missing(field, remedy))
    }

    pub fn words(&self, field: &str) -> Checked<Option<Vec<String>>> {
        let wrong = || self.error(field, "must be a list of words in quotes".into());
        let Some(value) = self.find(field) else { return Ok(None) };
        let DeValue::Array(items) = value.get_ref() else { return Err(wrong()) };
        let words = items.iter().map(|item| match item.get_ref() {
            DeValue::String(word) => Ok(word.to_string()),
            _ => Err(wrong()),
        });
        words.collect::<Checked<Vec<_>>>().map(Some)
    }

    pub fn numbers(&self, field: &str, count: usize) -> Checked<Option<Vec<f64>>> {
        let Some(value) = self.find(field) else { return Ok(None) };
        let DeValue::Array(items) = value.get_ref() else {
            return Err(self.error(field, format!("must be a list of {count} numbers")));
        };
        if items.len() != count {
            return Err(self.error(field, format!("must be a list of {count} numbers, has {}", items.len())));
        }
        items.iter().map(|item| self.as_number(field, item)).collect::<Checked<Vec<_>>>().map(Some)
    }

    /// One number, or a list of any length.
    pub fn required_list(&self, field: &str) -> Checked<Vec<f64>> {
        match self.find(field) {
            None => Err(self.missing(field, &format!("write {field} = a number, or a list of numbers"))),
            Some(value) => match value.get_ref() {
                DeValue::Array(items) => items.iter().map(|item| self.as_number(field, item)).collect(),
                _ => Ok(vec![self.as_number(field, value)?]),
            },
        }
    }

    /// Whether the field is given.
    pub fn has(&self, field: &str) -> bool {
        self.own.contains_key(field) || self.defaults.is_some_and(|table| table.contains_key(field))
    }

    pub fn required_numbers(&self, field: &str, count: usize) -> Checked<Vec<f64>> {
        self.numbers(field, count)?
            .ok_or_else(|| self.missing(field, &format!("write a list of {count} numbers")))
    }

    /// One number for all, or a list of `count`.
    pub fn one_or_many(&self, field: &str, count: usize) -> Checked<Option<Vec<f64>>> {
        match self.find(field) {
            None => Ok(None),
            Some(value) if matches!(value.get_ref(), DeValue::Array(_)) => self.numbers(field, count),
            Some(value) => Ok(Some(vec![self.as_number(field, value)?; count])),
        }
    }

    fn nested(&self, field: &str, value: &'t Spanned<DeValue<'t>>) -> Checked<Section<'t>> {
        match value.get_ref() {
            DeValue::Table(table) => {
                Ok(Section::new(table, value.span().start, &format!("{}.", self.name(field))))
            }
            other => Err(self.error(field, format!("must be a table, not a {}", other.type_str()))),
        }
    }

    /// A table inside this one; defaults are not looked into.
    pub fn table(&self, field: &str) -> Checked<Option<Section<'t>>> {
        self.asked.borrow_mut().insert(field.to_owned());
        self.own.get(field).map(|value| self.nested(field, value)).transpose()
    }

    pub fn tables(&self, field: &str) -> Checked<Vec<Section<'t>>> {
        self.asked.borrow_mut().insert(field.to_owned());
        match self.own.get(field).map(Spanned::get_ref) {
            None => Ok(Vec::new()),
            Some(DeValue::Array(items)) => items.iter().map(|item| self.nested(field, item)).collect(),
            Some(_) => Err(self.error(field, format!("must be written as [[{field}]]"))),
        }
    }

    /// Complains about the first field that nobody asked for: most likely a misspelt name.
    pub fn finish(&self) -> Checked<()> {
        let asked = self.asked.borrow();
        match self.own.iter().find(|(key, _)| !asked.contains(key.get_ref().as_ref())) {
            None => Ok(()),
            Some((key, _)) => Err(FieldError {
                at: key.span().start,
                field: self.name(key.get_ref()),
                message: format!(
                    "is not known here; known are {}",
                    asked.iter().map(String::as_str).collect::<Vec<_>>().join(", ")
                ),
            }),
        }
    }
}
