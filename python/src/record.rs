//! Results that are named numbers.

/// A frozen class with properties and a readable text. Methods may follow the fields.
macro_rules! record {
    (
        in $module:tt:
        $(#[$meta:meta])*
        $name:ident { $($(#[$doc:meta])* $field:ident: $type:ty),* $(,)? }
        $($methods:tt)*
    ) => {
        $(#[$meta])*
        #[pyo3::pyclass(frozen, get_all, module = $module)]
        #[derive(Clone, Debug)]
        pub struct $name {
            $($(#[$doc])* pub $field: $type),*
        }

        #[pyo3::pymethods]
        impl $name {
            fn __repr__(slf: &pyo3::Bound<'_, Self>) -> pyo3::PyResult<String> {
                $crate::record::text(slf.as_any(), stringify!($name), &[$(stringify!($field)),*])
            }

            $($methods)*
        }
    };
    ($(#[$meta:meta])* $name:ident $($rest:tt)*) => {
        $crate::record::record! { in "stick_slip": $(#[$meta])* $name $($rest)* }
    };
}
pub(crate) use record;

use pyo3::prelude::*;

/// The name with its fields; long ones by their shape.
pub fn text(object: &Bound<'_, PyAny>, name: &str, fields: &[&str]) -> PyResult<String> {
    const LONGEST: usize = 60;
    let field = |name: &&str| {
        let value = object.getattr(*name)?;
        let text = value.repr()?.to_string();
        if text.len() <= LONGEST && !text.contains('\n') {
            return Ok(format!("{name}={text}"));
        }
        let shape = value.getattr("shape").and_then(|shape| shape.repr());
        Ok(match shape {
            Ok(shape) => format!("{name}=<array {shape}>"),
            Err(_) => format!("{name}=..."),
        })
    };
    let fields: Vec<String> = fields.iter().map(field).collect::<PyResult<_>>()?;
    Ok(format!("{name}({})", fields.join(", ")))
}
