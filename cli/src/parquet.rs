//! Columns as a Parquet file, which data frames (pandas, Polars, R, Julia, MATLAB) read with types and names.
//!
//! Format: <https://parquet.apache.org/docs/file-format/>. One page a column and row group, plain values without compression; a number is
//! an optional double, a word a required string. The footer holds the columns' places and the texts about the whole.

use crate::columns::{Column, Columns, Values};
use polars_parquet_format::{
    ColumnChunk, ColumnMetaData, CompressionCodec, ConvertedType, DataPageHeader, Encoding,
    FieldRepetitionType, FileMetaData, KeyValue, LogicalType, PageHeader, PageType, RowGroup, SchemaElement,
    Statistics, StringType, Type,
    thrift::{self, protocol::TCompactOutputProtocol},
};
use std::{
    io::{self, Write},
    ops::Range,
};

const MAGIC: &[u8; 4] = b"PAR1";
/// Rows of a group: a page of them stays far below the format's 2 GB.
const MOST_ROWS: usize = 1 << 20;

/// Writes the columns.
pub fn write(columns: &Columns, out: &mut dyn Write) -> io::Result<()> {
    let mut out = Placed { out, at: 0 };
    out.write_all(MAGIC)?;
    let mut row_groups = vec![];
    for start in (0..columns.rows).step_by(MOST_ROWS) {
        row_groups.push(row_group(&columns.columns, start..columns.rows.min(start + MOST_ROWS), &mut out)?);
    }
    let version = env!("CARGO_PKG_VERSION");
    let program = [("freeact_version", version.to_owned())];
    let about = columns.about.iter().chain(&program);
    let root =
        SchemaElement { num_children: Some(columns.columns.len() as i32), ..element("schema", None, None) };
    let footer = FileMetaData {
        version: 1,
        schema: std::iter::once(root).chain(columns.columns.iter().map(schema)).collect(),
        num_rows: columns.rows as i64,
        row_groups,
        key_value_metadata: Some(
            about.map(|(key, text)| KeyValue { key: (*key).into(), value: Some(text.clone()) }).collect(),
        ),
        created_by: Some(format!("freeact version {version}")),
        column_orders: None,
        encryption_algorithm: None,
        footer_signing_key_metadata: None,
    };
    let mut bytes = vec![];
    footer.write_to_out_protocol(&mut TCompactOutputProtocol::new(&mut bytes)).map_err(failure)?;
    out.write_all(&bytes)?;
    out.write_all(&(bytes.len() as u32).to_le_bytes())?;
    out.write_all(MAGIC)
}

/// A writer that knows how far it is.
struct Placed<'a> {
    out: &'a mut dyn Write,
    at: i64,
}

impl Write for Placed<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.at += written as i64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

fn failure(error: thrift::Error) -> io::Error {
    io::Error::other(error.to_string())
}

fn element(name: &str, type_: Option<Type>, repetition_type: Option<FieldRepetitionType>) -> SchemaElement {
    SchemaElement {
        type_,
        type_length: None,
        repetition_type,
        name: name.into(),
        num_children: None,
        converted_type: None,
        scale: None,
        precision: None,
        field_id: None,
        logical_type: None,
    }
}

fn type_of(values: &Values) -> Type {
    match values {
        Values::Numbers(_) => Type::DOUBLE,
        Values::Words(_) => Type::BYTE_ARRAY,
    }
}

fn schema(column: &Column) -> SchemaElement {
    let type_ = Some(type_of(&column.values));
    match column.values {
        Values::Numbers(_) => element(&column.name, type_, Some(FieldRepetitionType::OPTIONAL)),
        Values::Words(_) => SchemaElement {
            converted_type: Some(ConvertedType::UTF8),
            logical_type: Some(LogicalType::STRING(StringType {})),
            ..element(&column.name, type_, Some(FieldRepetitionType::REQUIRED))
        },
    }
}

fn row_group(columns: &[Column], rows: Range<usize>, out: &mut Placed<'_>) -> io::Result<RowGroup> {
    let start = out.at;
    let chunks = columns.iter().map(|column| chunk(column, rows.clone(), out)).collect::<Result<_, _>>()?;
    Ok(RowGroup {
        columns: chunks,
        total_byte_size: out.at - start,
        num_rows: rows.len() as i64,
        sorting_columns: None,
        file_offset: Some(start),
        total_compressed_size: Some(out.at - start),
        ordinal: None,
    })
}

fn chunk(column: &Column, rows: Range<usize>, out: &mut Placed<'_>) -> io::Result<ColumnChunk> {
    let start = out.at;
    let count = rows.len();
    let (page, empty) = match &column.values {
        Values::Numbers(numbers) => number_page(&numbers[rows]),
        Values::Words(words) => (word_page(&words[rows]), 0),
    };
    let size = i32::try_from(page.len()).map_err(io::Error::other)?;
    let header = PageHeader {
        type_: PageType::DATA_PAGE,
        uncompressed_page_size: size,
        compressed_page_size: size,
        crc: None,
        data_page_header: Some(DataPageHeader {
            num_values: count as i32,
            encoding: Encoding::PLAIN,
            definition_level_encoding: Encoding::RLE,
            repetition_level_encoding: Encoding::RLE,
            statistics: None,
        }),
        index_page_header: None,
        dictionary_page_header: None,
        data_page_header_v2: None,
    };
    header.write_to_out_protocol(&mut TCompactOutputProtocol::new(&mut *out)).map_err(failure)?;
    out.write_all(&page)?;
    let statistics = Statistics {
        max: None,
        min: None,
        null_count: Some(empty),
        distinct_count: None,
        max_value: None,
        min_value: None,
        is_max_value_exact: None,
        is_min_value_exact: None,
    };
    let meta_data = ColumnMetaData {
        type_: type_of(&column.values),
        encodings: vec![Encoding::PLAIN, Encoding::RLE],
        path_in_schema: vec![column.name.clone()],
        codec: CompressionCodec::UNCOMPRESSED,
        num_values: count as i64,
        total_uncompressed_size: out.at - start,
        total_compressed_size: out.at - start,
        key_value_metadata: None,
        data_page_offset: start,
        index_page_offset: None,
        dictionary_page_offset: None,
        statistics: Some(statistics),
        encoding_stats: None,
        bloom_filter_offset: None,
        bloom_filter_length: None,
        size_statistics: None,
    };
    Ok(ColumnChunk {
        file_path: None,
        file_offset: start,
        meta_data: Some(meta_data),
        offset_index_offset: None,
        offset_index_length: None,
        column_index_offset: None,
        column_index_length: None,
        crypto_metadata: None,
        encrypted_column_metadata: None,
    })
}

/// Which rows have a number, as runs: twice the length as a varint, then 1 or 0; then the numbers that there are. And how many there are not.
fn number_page(numbers: &[Option<f64>]) -> (Vec<u8>, i64) {
    let mut levels: Vec<u8> = vec![];
    for run in numbers.chunk_by(|a, b| a.is_some() == b.is_some()) {
        let mut length = run.len() << 1;
        while length >= 0x80 {
            levels.push(length as u8 | 0x80);
            length >>= 7;
        }
        levels.push(length as u8);
        levels.push(u8::from(run[0].is_some()));
    }
    let mut page = (levels.len() as u32).to_le_bytes().to_vec();
    page.extend(levels);
    page.extend(numbers.iter().flatten().flat_map(|value| value.to_le_bytes()));
    (page, numbers.iter().filter(|value| value.is_none()).count() as i64)
}

/// Each word after its length.
fn word_page(words: &[&'static str]) -> Vec<u8> {
    let bytes = words.iter().map(|word| word.as_bytes());
    bytes.flat_map(|word| (word.len() as u32).to_le_bytes().into_iter().chain(word.iter().copied())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::Cell;
    use polars_parquet_format::thrift::protocol::TCompactInputProtocol;

    /// The numbers of a column chunk, read as the format says.
    fn numbers(bytes: &[u8], chunk: &ColumnChunk) -> Vec<Option<f64>> {
        let meta = chunk.meta_data.as_ref().unwrap();
        let mut rest = &bytes[meta.data_page_offset as usize..];
        let header =
            PageHeader::read_from_in_protocol(&mut TCompactInputProtocol::new(&mut rest, 1 << 20)).unwrap();
        let page = &rest[..header.compressed_page_size as usize];
        let (length, page) = page.split_at(4);
        let (mut levels, mut values) = page.split_at(u32::from_le_bytes(length.try_into().unwrap()) as usize);
        let mut found = vec![];
        while !levels.is_empty() {
            let (mut run, mut shift) = (0usize, 0);
            loop {
                let byte = levels[0];
                levels = &levels[1..];
                run |= usize::from(byte & 0x7f) << shift;
                shift += 7;
                if byte < 0x80 {
                    break;
                }
            }
            assert_eq!(run & 1, 0, "a run, not packed bits");
            for _ in 0..run >> 1 {
                found.push((levels[0] == 1).then(|| {
                    let (value, rest) = values.split_at(8);
                    values = rest;
                    f64::from_le_bytes(value.try_into().unwrap())
                }));
            }
            levels = &levels[1..];
        }
        assert!(values.is_empty() && found.len() as i64 == meta.num_values);
        found
    }

    #[test]
    fn what_is_written_is_read() {
        let mut columns =
            Columns::new(["x_mm", "status"].map(str::to_owned), &["status"]).about("name", "ein Schlauch");
        // Runs longer than a byte of a varint holds.
        for row in 0..1000 {
            let x = if (300..500).contains(&row) { Cell::Empty } else { Cell::Number(0.1 * f64::from(row)) };
            columns.push(&[x, Cell::Word(if row < 700 { "converged" } else { "limit point" })]);
        }
        let mut bytes = vec![];
        write(&columns, &mut bytes).unwrap();
        let end = bytes.len();
        assert!(&bytes[..4] == MAGIC && &bytes[end - 4..] == MAGIC);
        let length = u32::from_le_bytes(bytes[end - 8..end - 4].try_into().unwrap()) as usize;
        let mut footer = &bytes[end - 8 - length..end - 8];
        let footer =
            FileMetaData::read_from_in_protocol(&mut TCompactInputProtocol::new(&mut footer, 1 << 20))
                .unwrap();
        assert_eq!((footer.num_rows, footer.schema.len(), footer.row_groups.len()), (1000, 3, 1));
        let about = footer.key_value_metadata.unwrap();
        assert_eq!((about[0].key.as_str(), about[0].value.as_deref()), ("name", Some("ein Schlauch")));
        assert_eq!(about[1].key, "freeact_version");
        let chunks = &footer.row_groups[0].columns;
        assert_eq!(Values::Numbers(numbers(&bytes, &chunks[0])), columns.columns[0].values);
        assert_eq!(chunks[0].meta_data.as_ref().unwrap().statistics.as_ref().unwrap().null_count, Some(200));
    }

    #[test]
    fn columns_without_rows_are_a_file_too() {
        let mut bytes = vec![];
        write(&Columns::new(["a".to_owned()], &[]), &mut bytes).unwrap();
        assert!(bytes.starts_with(MAGIC) && bytes.ends_with(MAGIC));
    }
}
