/// @file
/// What Eigen's decompositions and products of matrices of any size are made of, compiled once (eigen_instances.cpp)
/// and not in every source that multiplies or decomposes. It is part of the precompiled headers: no source includes it,
/// and one that does without it compiles the same functions for itself. The templates are internal to Eigen 3.4; with
/// another version this header says nothing.
#pragma once

#include <Eigen/Dense>

#ifndef WEMS_EIGEN_INSTANCE
#define WEMS_EIGEN_INSTANCE extern template
#endif

#if EIGEN_WORLD_VERSION == 3 && EIGEN_MAJOR_VERSION == 4
namespace Eigen {

using WemsBlock = Block<MatrixXd, -1, -1, false>;
using WemsColumn = Block<const MatrixXd, -1, 1, false>;
using WemsColumnTail = VectorBlock<Block<MatrixXd, -1, 1, true>, -1>;

namespace internal {

template <int order>
using WemsConstMapper = const_blas_data_mapper<double, Index, order>;
using WemsMapper = blas_data_mapper<double, Index, ColMajor>;
using WemsTraits = gebp_traits<double, double>;

// Products.
WEMS_EIGEN_INSTANCE struct gebp_kernel<double, double, Index, WemsMapper, WemsTraits::mr, WemsTraits::nr, false, false>;
WEMS_EIGEN_INSTANCE struct gemm_pack_lhs<double, Index, WemsConstMapper<ColMajor>, WemsTraits::mr,
                                         WemsTraits::LhsProgress, WemsTraits::LhsPacket4Packing, ColMajor>;
WEMS_EIGEN_INSTANCE struct gemm_pack_lhs<double, Index, WemsConstMapper<RowMajor>, WemsTraits::mr,
                                         WemsTraits::LhsProgress, WemsTraits::LhsPacket4Packing, RowMajor>;
WEMS_EIGEN_INSTANCE struct gemm_pack_rhs<double, Index, WemsConstMapper<ColMajor>, WemsTraits::nr, ColMajor>;
WEMS_EIGEN_INSTANCE struct gemm_pack_rhs<double, Index, WemsConstMapper<RowMajor>, WemsTraits::nr, RowMajor>;
WEMS_EIGEN_INSTANCE struct gemm_pack_rhs<double, Index, WemsMapper, WemsTraits::nr, ColMajor, false, true>;
WEMS_EIGEN_INSTANCE struct general_matrix_matrix_product<Index, double, ColMajor, false, double, ColMajor, false,
                                                         ColMajor, 1>;
WEMS_EIGEN_INSTANCE struct general_matrix_matrix_product<Index, double, RowMajor, false, double, ColMajor, false,
                                                         ColMajor, 1>;
WEMS_EIGEN_INSTANCE struct general_matrix_matrix_product<Index, double, ColMajor, false, double, RowMajor, false,
                                                         ColMajor, 1>;
WEMS_EIGEN_INSTANCE struct general_matrix_vector_product<Index, double, WemsConstMapper<RowMajor>, RowMajor, false,
                                                         double, WemsConstMapper<ColMajor>, false, 0>;
WEMS_EIGEN_INSTANCE struct general_matrix_vector_product<Index, double, WemsConstMapper<RowMajor>, RowMajor, false,
                                                         double, WemsConstMapper<RowMajor>, false, 1>;
WEMS_EIGEN_INSTANCE struct general_matrix_vector_product<Index, double, WemsConstMapper<ColMajor>, ColMajor, false,
                                                         double, WemsConstMapper<RowMajor>, false, 0>;
WEMS_EIGEN_INSTANCE struct general_matrix_vector_product<Index, double, WemsConstMapper<ColMajor>, ColMajor, false,
                                                         double, WemsConstMapper<ColMajor>, false, 0>;
WEMS_EIGEN_INSTANCE struct selfadjoint_matrix_vector_product<double, Index, ColMajor, Lower, false, false, 0>;
WEMS_EIGEN_INSTANCE void evaluateProductBlockingSizesHeuristic<double, double, 1, Index>(Index&, Index&, Index&, Index);
WEMS_EIGEN_INSTANCE void evaluateProductBlockingSizesHeuristic<double, double, 4, Index>(Index&, Index&, Index&, Index);

// Triangular products and solutions.
WEMS_EIGEN_INSTANCE struct product_triangular_matrix_matrix<double, Index, Lower, true, ColMajor, false, ColMajor,
                                                            false, ColMajor, 1, 0>;
WEMS_EIGEN_INSTANCE struct product_triangular_matrix_matrix<double, Index, Upper, true, RowMajor, false, ColMajor,
                                                            false, ColMajor, 1, 0>;
WEMS_EIGEN_INSTANCE struct product_triangular_matrix_matrix<double, Index, UnitLower, true, ColMajor, false, ColMajor,
                                                            false, ColMajor, 1, 0>;
WEMS_EIGEN_INSTANCE struct product_triangular_matrix_matrix<double, Index, UnitUpper, true, RowMajor, false, ColMajor,
                                                            false, ColMajor, 1, 0>;
WEMS_EIGEN_INSTANCE struct triangular_matrix_vector_product<Index, UnitUpper, double, false, double, false, RowMajor,
                                                            0>;
WEMS_EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, ColMajor, ColMajor, 1>;
WEMS_EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, UnitLower, false, ColMajor, ColMajor, 1>;
WEMS_EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, Lower, false, ColMajor, ColMajor, 1>;
WEMS_EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheRight, Upper, false, RowMajor, ColMajor, 1>;
WEMS_EIGEN_INSTANCE struct triangular_solve_vector<double, double, Index, OnTheLeft, Lower, false, ColMajor>;
WEMS_EIGEN_INSTANCE struct triangular_solve_vector<double, double, Index, OnTheLeft, Upper, false, RowMajor>;

// Householder reflections.
WEMS_EIGEN_INSTANCE void apply_block_householder_on_the_left(WemsBlock&, const WemsBlock&,
                                                             const VectorBlock<const VectorXd, -1>&, bool);
WEMS_EIGEN_INSTANCE void tridiagonalization_inplace(MatrixXd&, VectorXd&);
WEMS_EIGEN_INSTANCE ComputationInfo computeFromTridiagonal_impl(VectorXd&, VectorXd&, Index, bool, MatrixXd&);

// Triangular decompositions.
WEMS_EIGEN_INSTANCE struct partial_lu_impl<double, ColMajor, int, -1>;
WEMS_EIGEN_INSTANCE struct llt_inplace<double, Lower>;

}  // namespace internal

WEMS_EIGEN_INSTANCE void MatrixBase<WemsBlock>::applyHouseholderOnTheLeft(const WemsColumn&, const double&, double*);
WEMS_EIGEN_INSTANCE void MatrixBase<WemsBlock>::applyHouseholderOnTheLeft(const WemsColumnTail&, const double&,
                                                                          double*);
WEMS_EIGEN_INSTANCE void MatrixBase<WemsBlock>::applyHouseholderOnTheRight(const WemsColumn&, const double&, double*);

// Decompositions of a matrix; one of an expression is compiled where it stands.
WEMS_EIGEN_INSTANCE SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
WEMS_EIGEN_INSTANCE SelfAdjointEigenSolver<MatrixXcd>& SelfAdjointEigenSolver<MatrixXcd>::compute(
    const EigenBase<MatrixXcd>&, int);
WEMS_EIGEN_INSTANCE EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);
WEMS_EIGEN_INSTANCE LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
WEMS_EIGEN_INSTANCE LLT<MatrixXcd>& LLT<MatrixXcd>::compute(const EigenBase<MatrixXcd>&);
WEMS_EIGEN_INSTANCE LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
WEMS_EIGEN_INSTANCE class SelfAdjointEigenSolver<MatrixXd>;
WEMS_EIGEN_INSTANCE class SelfAdjointEigenSolver<MatrixXcd>;
WEMS_EIGEN_INSTANCE class GeneralizedSelfAdjointEigenSolver<MatrixXd>;
WEMS_EIGEN_INSTANCE class EigenSolver<MatrixXd>;
WEMS_EIGEN_INSTANCE class RealSchur<MatrixXd>;
WEMS_EIGEN_INSTANCE class HouseholderQR<MatrixXd>;
WEMS_EIGEN_INSTANCE class ColPivHouseholderQR<MatrixXd>;
WEMS_EIGEN_INSTANCE class CompleteOrthogonalDecomposition<MatrixXd>;
WEMS_EIGEN_INSTANCE class PartialPivLU<MatrixXd>;
WEMS_EIGEN_INSTANCE class JacobiSVD<MatrixXd>;

}  // namespace Eigen
#endif
