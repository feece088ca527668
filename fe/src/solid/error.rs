/// Why a solid has no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolidError {
    /// A number of the specimen, of the mesh or of the request is outside what the solid can represent.
    #[error("{field} is {value}, but {requirement}")]
    Invalid {
        /// Which number.
        field: &'static str,
        /// Its value, SI unless the field says otherwise.
        value: f64,
        /// What would be accepted.
        requirement: &'static str,
    },
    /// An element of the undeformed mesh has no positive volume at one of its integration points.
    #[error(
        "element {element} of the mesh is inverted or degenerate (volume ratio {ratio:.2e} at an integration point): use more elements around or along, or a smaller offset"
    )]
    Degenerate {
        /// Which element, counted radially, then around, then along.
        element: usize,
        /// Its Jacobian over that of the average.
        ratio: f64,
    },
    /// Newton's method found no equilibrium even by the shortest steps allowed.
    #[error(
        "no equilibrium found towards {target} (relative residual {residual:.1e}); the last good state is at {last_good:.4} kPa. {advice}"
    )]
    NotConverged {
        /// What was asked for, in words.
        target: String,
        /// Relative residual where the iteration gave up; NaN when an element was turned inside out.
        residual: f64,
        /// Pressure of the nearest state in equilibrium, kPa.
        last_good: f64,
        /// What to do.
        advice: &'static str,
    },
    /// A step left the branch of equilibria that it started on.
    #[error(
        "between {from} and {to} the path jumps to another branch of equilibria: negative eigenvalues {before} before, {after} after, and no critical point that joins them. Use closer stops"
    )]
    Jumped {
        /// Parameter of the path where the step began.
        from: f64,
        /// And where it ended.
        to: f64,
        /// Negative eigenvalues of the tangent before.
        before: usize,
        /// And after.
        after: usize,
    },
    /// The tangent could not be factorised.
    #[error("the tangent cannot be factorised: {0}")]
    Singular(String),
    /// The computation was asked to stop.
    #[error("stopped as asked")]
    Stopped,
}
